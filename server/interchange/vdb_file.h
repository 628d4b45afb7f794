// Writes scalar grids as an OpenVDB file. The grids are sparse, have half floats on disk and a
// linear transform to world metres. This code does not depend on storms.
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

// Number of cells along the edge of an OpenVDB leaf block. OpenVDB stores a whole block if any of
// its cells has a value.
inline constexpr int kVdbBlockCells = 8;
using VdbBlock = std::array<float, std::size_t{kVdbBlockCells} * kVdbBlockCells * kVdbBlockCells>;

struct VdbGrid {
  std::string name;
  // The cells of this grid become the voxels of the file, with the same indices (x, y, z). The
  // world position of a voxel is its cell's centre.
  volume::RegularGrid grid;
  VdbMetadata metadata;
  // Fills `values` (x fastest) for the block of cells that begins at `first`, and returns true.
  // Returns false if all values of the block are zero. Values for cells beyond the grid are
  // ignored. Values must be from 0 to kLargestVdbValue; values that round to zero are not stored.
  // Called from several threads.
  std::function<bool(const glm::ivec3& first, VdbBlock& values)> fill;
};

inline constexpr float kLargestVdbValue = 65504.0F;  // largest value of a half float

struct VdbFile {
  std::vector<VdbGrid> grids;
  VdbMetadata metadata;
};

// Writes the file under a temporary name and then renames it, so that readers never see a partial
// file. `progress` (may be empty) receives the completed share, 0 to 1. Returns UNAVAILABLE if
// `path` cannot be written, and CANCELLED if `stop` is requested.
absl::Status WriteVdb(const VdbFile& file, const std::string& path,
                      const std::function<void(double share)>& progress,
                      const std::stop_token& stop);

}  // namespace thunderhead::interchange
