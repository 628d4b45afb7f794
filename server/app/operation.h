// The parts of `thunderhead serve` that operators use: its log, its operator port, and its
// shutdown.
#pragma once

#include <chrono>
#include <csignal>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "base/timed_calls.h"
#include "service/server.h"
#include "telemetry/operator_port.h"
#include "telemetry/watchdog.h"

namespace thunderhead::app {

struct OperationFlags {
  std::string metrics;  // HOST:PORT of the operator port; empty for no port
  std::string log_format = "text";
  double drain_s = 30.0;
  double stuck_s = 120.0;
};

void AddOperationFlags(CLI::App& command, OperationFlags& flags);

// Sets the format of the log on standard error: text, or JSON with one object per line.
void SetLogFormat(const std::string& format);

// Starts a thread that ends the process with exit code 0 when one of `signals` arrives, unless the
// thread is told to stop before. All threads must block these signals.
std::jthread EndIfToldWhileStarting(const sigset_t& signals);

// Starts a thread that ends the process after `patience`, unless the thread is told to stop before.
// It calls `last` and exits with the result of `code`. Without this thread, a call that hangs with
// its storage could keep the server from ending.
std::jthread EndAnywayAfter(std::chrono::seconds patience, const std::function<int()>& code,
                            const std::function<void()>& last);

// The operator port, if the flags ask for one, and the messages to systemd. The port serves at
// once. Until SetServer is called, it reports that the server is starting.
class Operation {
 public:
  // Sets the format of the log, opens the operator port if the flags ask for one, and starts the
  // messages to systemd. If `allowed_hosts` is not empty, the port answers only requests for these
  // names and for the names that the page accepts. Otherwise it answers requests for any name.
  static absl::StatusOr<std::unique_ptr<Operation>> Start(
      const OperationFlags& flags, const std::vector<std::string>& allowed_hosts = {});
  ~Operation();
  Operation(const Operation&) = delete;
  Operation& operator=(const Operation&) = delete;

  // Memory and storage that a server uses. Each pointer may be null.
  struct Resources {
    std::shared_ptr<const base::MemoryBudget> memory;
    std::shared_ptr<const base::MemoryBudget> gpu_memory;
    std::shared_ptr<base::TimedCalls> state;  // calls to the storage of the state folder
  };

  // Sets the server and its resources. The server must stay alive until SetServer(nullptr) is
  // called. While a server is set, its gRPC health service reports the health that this object
  // determines.
  void SetServer(service::Server* server, Resources resources);
  void SetServer(std::nullptr_t) { SetServer(nullptr, {}); }

  // Waits for one of `signals`, which this thread must block, and then tells the clients that the
  // server stops. Returns when the started pictures are delivered and all viewers have left, or
  // after the grace period. If a second signal arrives, it calls `last`, which must be fast, and
  // ends the process.
  void WaitAndDrain(
      const sigset_t& signals, service::Server& server, const std::function<void()>& last = [] {});

 private:
  explicit Operation(const OperationFlags& flags) : flags_(flags) {}

  // Returns for how many seconds the state folder has not responded. The caller must hold mutex_.
  double StateHangsFor();
  std::string MetricsText();
  telemetry::Health HealthNow();

  const OperationFlags flags_;
  std::mutex mutex_;
  const service::Server* server_ = nullptr;
  Resources resources_;
  bool ended_ = false;
  std::unique_ptr<telemetry::OperatorPort> port_;
  std::unique_ptr<telemetry::Watchdog> watchdog_;  // null if no supervisor waits for messages
  std::jthread telling_;
  std::jthread second_signal_;
};

}  // namespace thunderhead::app
