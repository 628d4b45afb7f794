// Tells systemd that the process makes progress, where its unit has WatchdogSec: without such a
// message for that time, systemd restarts it. Needs no library: a message is a datagram.
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
  // As the environment says (sd_watchdog_enabled(3)); null if no supervisor waits for messages. As
  // long as `alive` is true, they are sent on a thread of its own, three in the time that
  // systemd waits. INVALID_ARGUMENT for an environment that makes no sense.
  static absl::StatusOr<std::unique_ptr<Watchdog>> StartIfAsked(std::function<bool()> alive);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  Watchdog(const std::string& socket, std::chrono::microseconds pause, std::function<bool()> alive);

  std::jthread thread_;
};

}  // namespace thunderhead::telemetry
