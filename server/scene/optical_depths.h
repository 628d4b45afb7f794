// The storm's optical depth along the ray of each pixel, and the distance at which it reaches 1.
// Both are computed from the fields without GL, so they are available for every technique.
#pragma once

#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Sets `optical_depth` and `depth_one_distance_m` of `picture`, which shows the scene at any size.
// The rays pass through the pixel centres and end at the ground. The medium is the one that the
// scene's technique draws, with turbulent detail if the technique shows it. For techniques that
// draw no medium (metaballs, cumulus, path-traced reference), the medium is the fields without
// detail. The computation uses several threads.
void AddOpticalDepths(const Scene& scene, const volume::HydrometeorFields& fields,
                      picture::LinearPicture* picture);

}  // namespace thunderhead::scene
