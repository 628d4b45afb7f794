// Where probes look from: low-discrepancy sequences of cameras. Pure functions.
#pragma once

#include <cstdint>

#include "scene/scene.h"
#include "volume/visible_box.h"

namespace thunderhead::accuracy {

// Number `index` of the cameras that frame the box from all sides, evenly over the upper half.
scene::Camera AroundStorm(const volume::WorldBox& box, double aspect_ratio, std::uint64_t index);

// `camera` moved about the box's middle by 10 degrees at most, nearer or farther by a twentieth.
scene::Camera Nudged(const scene::Camera& camera, const volume::WorldBox& box, std::uint64_t index);

}  // namespace thunderhead::accuracy
