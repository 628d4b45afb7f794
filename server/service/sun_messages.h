// The sun of a scene message: where its direction comes from, and what it is by the clock.
#pragma once

#include "absl/status/status.h"
#include "scene/scene.h"
#include "thunderhead/v1/scene.pb.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

// INVALID_ARGUMENT where the clock's date is none.
absl::Status CheckSun(const v1::Sun& sun);

// Fills in the source, and for a sun that follows the clock its time, place and direction at
// `time_index`, whatever direction the message had.
void FillSunDefaults(v1::Sun& sun, const volume::StormInfo& storm, int time_index);

// Fills in the time and place of the storm where absent.
void FillClockDefaults(v1::SunClock& clock, const volume::StormInfo& storm);

void ToMessage(const scene::Sun& sun, v1::Sun& message);

}  // namespace thunderhead::service
