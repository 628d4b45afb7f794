// Conversion of a TimeSource's times for alarms of gRPC.
#pragma once

#include <chrono>

#include "base/time_source.h"

namespace thunderhead::service {

// Returns the system clock's time at which an alarm for `due` must fire. The alarm's callback must
// check `time` again, and set another alarm if `due` has not passed.
inline std::chrono::system_clock::time_point AlarmTime(const base::TimeSource& time,
                                                       base::TimeSource::Clock::time_point due) {
  return std::chrono::system_clock::now() +
         std::chrono::ceil<std::chrono::system_clock::duration>(time.LookAgainAt(due) -
                                                                base::TimeSource::Clock::now());
}

}  // namespace thunderhead::service
