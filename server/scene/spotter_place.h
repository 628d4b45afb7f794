// The place of a spotter for requests that give none. It is about 15 to 25 km from the strongest
// core, or farther if an anvil would be overhead. It is on a side that the sun lights and from
// which little rain hides the core's base.
#pragma once

#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::scene {

// The directions that may be chosen.
enum class SpottersSide { kBest, kOppositeAzimuth };

// Returns `camera` with a place, azimuth and elevation that show the whole tower. Ground fills a
// sixth to a quarter of the picture's height. `camera` gives eye height and lens. With
// kOppositeAzimuth it also gives the azimuth to look to. With kBest its azimuth only decides
// between equal sides. `towards_sun` is a unit vector. A sun below the horizon lights no side.
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
