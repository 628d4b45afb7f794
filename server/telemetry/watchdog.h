// Tells systemd that the process makes progress, if its unit has WatchdogSec. Without such a
// message for that time, systemd restarts the process. No library is needed, because a message is a
// datagram.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"

namespace thunderhead::telemetry {

class Watchdog {
 public:
  // Starts as the environment says (sd_watchdog_enabled(3)). Returns null if no supervisor waits
  // for messages. While `alive` is true, a separate thread sends three messages in the time that
  // systemd waits. Returns INVALID_ARGUMENT for an invalid environment.
  static absl::StatusOr<std::unique_ptr<Watchdog>> StartIfAsked(std::function<bool()> alive);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  Watchdog(const std::string& socket, std::chrono::microseconds pause, std::function<bool()> alive);

  std::jthread thread_;
};

}  // namespace thunderhead::telemetry
