// Reports to systemd that the process makes progress, if its unit has the option WatchdogSec. If
// systemd receives no such message for that time, it restarts the process. A message is a datagram,
// so no library is needed.
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
  // Starts a watchdog if the environment variables request one (sd_watchdog_enabled(3)), and
  // otherwise returns null. While `alive` returns true, a separate thread sends three messages in
  // each period of WatchdogSec. Returns INVALID_ARGUMENT if the variables are invalid.
  static absl::StatusOr<std::unique_ptr<Watchdog>> StartIfAsked(std::function<bool()> alive);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  Watchdog(const std::string& socket, std::chrono::microseconds pause, std::function<bool()> alive);

  std::jthread thread_;
};

}  // namespace thunderhead::telemetry
