// Converts times of a TimeSource for gRPC's alarms, which use the system clock.
#pragma once

#include <chrono>

#include "base/time_source.h"

namespace thunderhead::rpc_port {

// Returns the system clock's time at which to set an alarm for `due`. When the alarm fires, its
// callback must check `time`, and set another alarm if `due` has not been reached.
inline std::chrono::system_clock::time_point AlarmTime(const base::TimeSource& time,
                                                       base::TimeSource::Clock::time_point due) {
  return std::chrono::system_clock::now() +
         std::chrono::ceil<std::chrono::system_clock::duration>(time.LookAgainAt(due) -
                                                                base::TimeSource::Clock::now());
}

}  // namespace thunderhead::rpc_port
