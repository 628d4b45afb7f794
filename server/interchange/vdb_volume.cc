#include "interchange/vdb_volume.h"

#include "glm/vector_relational.hpp"

namespace thunderhead::interchange {

absl::Status CheckPlausible(const VdbVolume& volume) {
  if (glm::any(glm::lessThan(volume.voxels, glm::ivec3(1)))) {
    return absl::InternalError("its number of voxels");
  }
  const std::int64_t layer = std::int64_t{volume.voxels.x} * volume.voxels.y;
  if (layer > kMostVdbVoxels || layer * volume.voxels.z > kMostVdbVoxels ||
      volume.values.size() != volume.VoxelCount()) {
    return absl::InternalError("its number of values");
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::interchange
