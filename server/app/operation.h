// An operator's side of `thunderhead serve`: its log, its operator's port, and its end.
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
#include "base/patient_calls.h"
#include "service/server.h"
#include "telemetry/operator_port.h"
#include "telemetry/watchdog.h"

namespace thunderhead::app {

struct OperationFlags {
  std::string metrics;  // HOST:PORT; empty: no port
  std::string log_format = "text";
  double drain_s = 30.0;
  double stuck_s = 120.0;
};

void AddOperationFlags(CLI::App& command, OperationFlags& flags);

// Text, or JSON with one object a line, on standard error.
void SetLogFormat(const std::string& format);

// While the thread runs, one of `signals`, which all threads must block, ends the process at once
// with 0.
std::jthread EndIfToldWhileStarting(const sigset_t& signals);

// Ends the process with what `code` gives, after `last`, unless the thread is told to stop within
// `patience`: a call that hangs with its storage would keep its server from ending for ever.
std::jthread EndAnywayAfter(std::chrono::seconds patience, const std::function<int()>& code,
                            const std::function<void()>& last);

// The operator's port of the flags, null without one, and what systemd is told. The port serves at
// once, and says that the server starts until it is given one.
class Operation {
 public:
  // With `allowed_hosts` the port answers to them, and to what the page does besides; without, to
  // any name.
  static absl::StatusOr<std::unique_ptr<Operation>> Start(
      const OperationFlags& flags, const std::vector<std::string>& allowed_hosts = {});
  ~Operation();
  Operation(const Operation&) = delete;
  Operation& operator=(const Operation&) = delete;

  // Memory and storage that a server uses; each may be null.
  struct Resources {
    std::shared_ptr<const base::MemoryBudget> memory;
    std::shared_ptr<const base::MemoryBudget> gpu_memory;
    std::shared_ptr<base::PatientCalls> state;  // calls to the state folder
  };

  // The server, which must outlive what follows until SetServer(nullptr), and its resources.
  // gRPC's health service is told of its health while there is one.
  void SetServer(service::Server* server, Resources resources);
  void SetServer(std::nullptr_t) { SetServer(nullptr, {}); }

  // Waits for SIGINT or SIGTERM, which this thread blocks; tells the clients, and returns when the
  // pictures that were begun are delivered, at the latest after the grace. From then on a second
  // signal ends the process at once, but for `last`, which must not take long.
  void WaitAndDrain(
      const sigset_t& signals, service::Server& server, const std::function<void()>& last = [] {});

 private:
  explicit Operation(const OperationFlags& flags) : flags_(flags) {}

  // Needs mutex_.
  double StateHangsFor();
  std::string MetricsText();
  telemetry::Health HealthNow();

  const OperationFlags flags_;
  std::mutex mutex_;
  const service::Server* server_ = nullptr;
  Resources resources_;
  bool ended_ = false;
  std::unique_ptr<telemetry::OperatorPort> port_;
  std::unique_ptr<telemetry::Watchdog> watchdog_;  // null: no supervisor waits for messages
  std::jthread telling_;
  std::jthread second_signal_;
};

}  // namespace thunderhead::app
