// The cameras of probes (accuracy/light_corrector.h), as low-discrepancy sequences.
#pragma once

#include <cstdint>

#include "scene/scene.h"
#include "volume/visible_box.h"

namespace thunderhead::accuracy {

// Returns camera `index` of a sequence that frames the box from all sides, evenly over the upper
// hemisphere.
scene::Camera AroundStorm(const volume::WorldBox& box, double aspect_ratio, std::uint64_t index);

// Returns `camera` turned by at most 10 degrees, and moved closer or farther away by at most a
// twentieth of its distance. An orbit camera turns around its target and is also tilted by at most
// 3 degrees. A spotter camera turns around the box's middle. Only the width of a top-down camera
// changes.
scene::Camera Nudged(const scene::Camera& camera, const volume::WorldBox& box, std::uint64_t index);

}  // namespace thunderhead::accuracy
