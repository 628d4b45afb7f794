// Writes scalar grids as an OpenVDB file: sparse, half floats on disk, each with a linear transform
// to world metres. vdb_file.cc alone includes OpenVDB, whose headers take long to compile. Knows no
// storm.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "volume/grid.h"

namespace thunderhead::interchange {

using VdbMetadata = std::map<std::string, std::variant<std::string, double, std::int64_t>>;

// Cells along an edge of a block: OpenVDB stores a block whole if any of its cells has a value.
inline constexpr int kVdbBlockCells = 8;
using VdbBlock = std::array<float, std::size_t{kVdbBlockCells} * kVdbBlockCells * kVdbBlockCells>;

struct VdbGrid {
  std::string name;
  // Voxel (x, y, z) of the file is this grid's cell, and its place in the world the cell's centre.
  volume::RegularGrid grid;
  VdbMetadata metadata;
  // Sets `values`, x fastest, for the block of cells that begins at `first`, and returns true; or
  // returns false if all are zero. Cells beyond the grid are ignored. Values are from 0 to
  // kLargestVdbValue; those that round to zero are not stored. Called from several threads.
  std::function<bool(const glm::ivec3& first, VdbBlock& values)> fill;
};

inline constexpr float kLargestVdbValue = 65504.0F;  // of a half float

struct VdbFile {
  std::vector<VdbGrid> grids;
  VdbMetadata metadata;
};

// Writes to a temporary name and renames, so that nobody sees half a file. `progress` (may be
// empty) is told the share done, 0 to 1. Errors: UNAVAILABLE if `path` cannot be written, CANCELLED
// if asked to stop.
absl::Status WriteVdb(const VdbFile& file, const std::string& path,
                      const std::function<void(double share)>& progress,
                      const std::stop_token& stop);

}  // namespace thunderhead::interchange
