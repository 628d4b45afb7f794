// Converts the sun of a scene message: the source of its direction, and its position by date, time
// and place.
#pragma once

#include "absl/status/status.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::service {

// Returns INVALID_ARGUMENT if the clock's date is malformed.
absl::Status CheckSun(const v1::Sun& sun);

// Fills in the source of the direction. If the sun follows the clock, also fills in the clock's
// time and place. The sun's direction at `time_index` then replaces the message's direction. Its
// azimuth counts from the grid's north, as all azimuths of a scene do.
void FillSunDefaults(v1::Sun& sun, const storm_store::StormInfo& storm, int time_index);

// Fills in the storm's time and place if they are absent.
void FillClockDefaults(v1::SunClock& clock, const storm_store::StormInfo& storm, int time_index);

void ToMessage(const scene::Sun& sun, v1::Sun& message);

}  // namespace thunderhead::service
