// Alarms of gRPC for times of a TimeSource.
#pragma once

#include <chrono>

#include "base/time_source.h"

namespace thunderhead::service {

// Returns the time of the system's clock at which an alarm for `due` must ring. The code that it
// calls must look at `time` again, and set another alarm if `due` has not passed by it.
inline std::chrono::system_clock::time_point AlarmTime(const base::TimeSource& time,
                                                       base::TimeSource::Clock::time_point due) {
  return std::chrono::system_clock::now() +
         std::chrono::ceil<std::chrono::system_clock::duration>(time.LookAgainAt(due) -
                                                                base::TimeSource::Clock::now());
}

}  // namespace thunderhead::service
