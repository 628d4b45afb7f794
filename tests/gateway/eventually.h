#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace thunderhead::gateway::test {

// Waits for an effect of another thread; long, because sanitizers and busy machines are slow.
inline bool Eventually(const std::function<bool()>& condition) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (std::chrono::steady_clock::now() < patience) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

}  // namespace thunderhead::gateway::test
