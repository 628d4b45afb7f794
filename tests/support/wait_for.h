// Waits for conditions in tests, however slow the machine is.
#pragma once

#include <chrono>
#include <thread>

namespace thunderhead::testing {

// The longest wait before a test counts as hung. It is not a performance requirement, because ten
// other processes may compete with the test for one processor.
inline constexpr std::chrono::minutes kHangLimit{10};

// Waits until `condition()` is true. Returns false only after kHangLimit.
template <typename Condition>
bool WaitFor(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kHangLimit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace thunderhead::testing
