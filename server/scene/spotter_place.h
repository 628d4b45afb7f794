// The position that a spotter camera gets when a request gives none. It is about 15 to 25 km from
// the strongest core, or farther if an anvil would be overhead. It is on a side of the storm that
// the sun lights and from which little rain hides the core's base.
#pragma once

#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::scene {

// The sides of the core on which SpottingCore may place the spotter.
enum class SpottersSide { kBest, kOppositeAzimuth };

// Returns `camera` with a place, azimuth and elevation that show the core's whole cloud tower.
// Ground fills a sixth to a quarter of the picture's height. `camera` gives the eye height and
// focal length. With kOppositeAzimuth, `camera` also gives the azimuth in which the spotter looks.
// With kBest, its azimuth only decides between equally good sides. `towards_sun` is a unit vector.
// If the sun is below the horizon, no side counts as lit.
//
// The distance is the smallest that shows the tower's top. It is 1.25 to 2.1 times the tower's
// height (15 to 25 km for 12 km), and 15 to 25 km for a higher tower. It is larger if cloud or rain
// surrounds the eye and, with kBest, if cloud covers the sky above the tower. If the lens is too
// long for that distance, the top is cut off.
SpotterCamera SpottingCore(SpotterCamera camera, SpottersSide side,
                           const volume::HydrometeorFields& fields, const volume::StormCore& core,
                           physics::SizeSource sizes, const glm::dvec3& towards_sun,
                           double aspect_ratio);

// Returns the spotter at its own place, turned to the core with the tilt that SpottingCore uses.
SpotterCamera LookingAt(SpotterCamera camera, const volume::HydrometeorFields& fields,
                        const volume::StormCore& core, double aspect_ratio);

}  // namespace thunderhead::scene
