// Where a spotter stands who is told no place: some 15 to 25 km from the strongest core, farther
// where an anvil would be overhead, on a side that the sun lights and from which the least rain
// hides its base.
#pragma once

#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::scene {

// Which directions may be chosen.
enum class SpottersSide { kBest, kOppositeAzimuth };

// `camera` with a place, azimuth and elevation from which the whole tower is in the picture, the
// ground filling a sixth to a quarter of its height. `camera` gives eye height and lens; with
// kOppositeAzimuth also the azimuth it looks to, else only which of equal sides is taken.
// `towards_sun` is a unit vector; a sun below the horizon lights no side.
//
// The distance is the smallest that shows the tower's top, from 1.25 to 2.1 times the tower's
// height (15 to 25 km for 12 km), and for a higher tower from 15 to 25 km; more where there is
// cloud or rain around the eye, and with kBest where cloud covers the sky above the tower. If the
// lens is too long for that, the top is cut off.
SpotterCamera SpottingCore(SpotterCamera camera, SpottersSide side,
                           const volume::HydrometeorFields& fields, const volume::StormCore& core,
                           physics::SizeSource sizes, const glm::dvec3& towards_sun,
                           double aspect_ratio);

// The spotter where it stands, its head turned to the core, as above.
SpotterCamera LookingAt(SpotterCamera camera, const volume::HydrometeorFields& fields,
                        const volume::StormCore& core, double aspect_ratio);

}  // namespace thunderhead::scene
