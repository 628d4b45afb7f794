// A medium of the path tracer (reference::Medium) on the device, in the layout that shaders/paths/
// reads.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "glm/vec3.hpp"
#include "reference/medium.h"

namespace thunderhead::device_paths {

class DeviceMedium {
 public:
  // Copies `medium` to the device. Returns UNIMPLEMENTED if it has periodic sides, constant cells,
  // more than eight groups, or more cells along a side than the device's textures allow. Throws
  // base::FailedAllocation if there is not enough memory.
  static absl::StatusOr<DeviceMedium> Of(const reference::Medium& medium);

  // Returns the defines of paths/trace.comp.
  gl::Defines Defines() const { return {{"GROUPS", groups_}}; }
  void Bind(const gl::Program& program) const;
  // Converts world coordinates to brick units relative to the lower corner of the first brick.
  glm::dvec3 InBricks(const glm::dvec3& point_m) const {
    return (point_m - brick_low_m_) / brick_m_;
  }
  const glm::dvec3& BrickLow_m() const { return brick_low_m_; }

 private:
  explicit DeviceMedium(const reference::Medium& medium);
  void UploadGroups(const reference::Medium& medium);
  void UploadOptics(const reference::Medium& medium);

  int groups_;
  glm::dvec3 brick_low_m_;
  glm::dvec3 brick_m_;
  glm::dvec3 box_low_;  // box corners in units of bricks
  glm::dvec3 box_high_;
  glm::ivec3 cells_;
  glm::ivec3 bricks_;
  glm::ivec3 first_cell_;
  gl::Texture3D extinctions_;
  gl::Texture3D majorants_;
  std::vector<gl::Texture3D> group_extinctions_;
  gl::Buffer optics_;
  gl::Buffer phases_;
};

}  // namespace thunderhead::device_paths
