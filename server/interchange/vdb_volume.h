// One grid of an OpenVDB file as a dense array, with the axes and units of the file. This code does
// not use OpenVDB, so that the program that imports the grid does not parse the file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "glm/vec3.hpp"

namespace thunderhead::interchange {

// The largest number of voxels in the box of a grid's active voxels. Its floats take 2 GiB.
inline constexpr std::int64_t kMostVdbVoxels = std::int64_t{1} << 29;

struct VdbVolume {
  std::string grid;       // its name
  glm::ivec3 voxels{0};   // number of voxels along the axes i, j and k of the file's index
  glm::dvec3 first{0.0};  // world position of the centre of the first voxel
  std::array<glm::dvec3, 3> steps;  // from a voxel's centre to the next along i, j and k
  std::vector<float> values;        // i fastest; 0 for voxels that are not active

  std::size_t VoxelCount() const {
    return static_cast<std::size_t>(voxels.x) * static_cast<std::size_t>(voxels.y) *
           static_cast<std::size_t>(voxels.z);
  }
};

// Checks a volume that another process sent. Returns INTERNAL, whose message names the implausible
// value.
absl::Status CheckPlausible(const VdbVolume& volume);

// Sends or receives the volume, as in sandbox/messages.h.
template <typename Archive>
void Visit(Archive& archive, VdbVolume& volume) {
  auto& [grid, voxels, first, steps, values] = volume;
  archive(grid);
  archive(voxels);
  archive(first);
  archive(steps);
  archive(values);
}

}  // namespace thunderhead::interchange
