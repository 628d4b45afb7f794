// The storm's optical depth along the ray of each pixel, and where it reaches 1. Computed from the
// fields, so it is the same whichever technique draws the picture; without GL.
#pragma once

#include "picture/linear_picture.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Sets `optical_depth` and `depth_one_distance_m` of a picture of the scene, of any size, from rays
// through the middles of its pixels up to the ground. The medium is the one that the scene's
// technique draws, with turbulent detail where that has it; for techniques that draw no medium
// (metaballs, a cumulus' surface, the reference) the fields without detail. On several threads.
void AddOpticalDepths(const Scene& scene, const volume::HydrometeorFields& fields,
                      picture::LinearPicture* picture);

}  // namespace thunderhead::scene
