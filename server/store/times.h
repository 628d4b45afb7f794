// Conversion of times to and from the tables' format: milliseconds since 1970.
#pragma once

#include <chrono>
#include <cstdint>

namespace thunderhead::store {

inline std::int64_t MillisecondsOf(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

inline std::chrono::system_clock::time_point TimeOf(std::int64_t milliseconds) {
  return std::chrono::system_clock::time_point(std::chrono::milliseconds(milliseconds));
}

}  // namespace thunderhead::store
