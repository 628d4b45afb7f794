#include "app/operation.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/address.h"
#include "app/log_format.h"
#include "base/status.h"
#include "gateway/http_policy.h"
#include "sandbox/child.h"
#include "spdlog/sinks/sink.h"
#include "spdlog/spdlog.h"
#include "telemetry/exposition.h"

namespace thunderhead::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// One request may arrive as several signals (interruption.cc).
constexpr milliseconds kOneRequest{250};

// A worker counts as stalled if it has drawn nothing for --stuck-seconds times this factor.
constexpr double kWorkerFactor = 5.0;

// Interval between checks of the health that is reported to gRPC's clients.
constexpr std::chrono::seconds kHealthPause{1};

// Waits up to 20 ms for one of `signals`. Returns the signal that came, or 0.
int Taken(const sigset_t& signals) {
  const timespec wait{0, std::chrono::nanoseconds(milliseconds(20)).count()};
  return std::max(0, sigtimedwait(&signals, nullptr, &wait));
}

void AddBudget(const std::string& name, const base::MemoryBudget* budget,
               std::vector<telemetry::Gauge>& gauges) {
  if (budget == nullptr) return;
  gauges.push_back({absl::StrCat("thunderhead_", name, "_bytes"), "Size of the budget in bytes",
                    static_cast<double>(budget->Bytes())});
  for (const base::MemoryUse use : base::kMemoryUses) {
    gauges.push_back({absl::StrCat("thunderhead_", name, "_used_bytes"),
                      "Bytes of the budget in use", static_cast<double>(budget->Used(use)), "use",
                      std::string(base::LabelOf(use))});
  }
}

}  // namespace

void AddOperationFlags(CLI::App& command, OperationFlags& flags) {
  command.add_option("--metrics", flags.metrics,
                     "HOST:PORT for operators: /metrics for Prometheus, /healthz and /readyz");
  command.add_option("--log-format", flags.log_format, "text, or json: one object per line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command
      .add_option(
          "--drain-seconds", flags.drain_s,
          "Seconds after SIGTERM or SIGHUP in which single images already begun are finished, and "
          "viewers, who are notified, may leave")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command
      .add_option("--stuck-seconds", flags.stuck_s,
                  "Seconds after which a turn of drawing makes /healthz ask for a restart")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
}

void SetLogFormat(const std::string& format) {
  if (format != "json") return;
  for (const auto& sink : spdlog::default_logger()->sinks()) {
    sink->set_formatter(std::make_unique<JsonFormatter>());
  }
}

absl::StatusOr<std::unique_ptr<Operation>> Operation::Start(
    const OperationFlags& flags, const std::vector<std::string>& allowed_hosts) {
  SetLogFormat(flags.log_format);
  std::unique_ptr<Operation> operation(new Operation(flags));
  THUNDERHEAD_ASSIGN_OR_RETURN(operation->watchdog_,
                               telemetry::Watchdog::StartIfAsked(
                                   [raw = operation.get()] { return raw->HealthNow().alive; }));
  if (flags.metrics.empty()) return operation;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Address address, ParseAddress("--metrics", flags.metrics));
  Operation* const self = operation.get();
  telemetry::OperatorPages pages{.metrics = [self] { return self->MetricsText(); },
                                 .health = [self] { return self->HealthNow(); },
                                 .allows_host = {}};
  if (!allowed_hosts.empty()) {
    pages.allows_host = [policy = gateway::HttpPolicy(/*loopback=*/false, allowed_hosts, {})](
                            std::string_view host) { return policy.AllowsHost(host); };
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(operation->port_, telemetry::OperatorPort::Open(
                                                     address.host, address.port, std::move(pages)));
  spdlog::info("operators at http://{}/metrics, /healthz and /readyz",
               ToString({address.host, operation->port_->Port()}));
  return operation;
}

Operation::~Operation() {
  port_.reset();
  watchdog_.reset();
  telling_ = {};
  second_signal_.request_stop();
}

void Operation::SetServer(service::Server* server, Resources resources) {
  // The thread that reports to gRPC's clients takes the same lock, so it is ended before the lock
  // is taken here.
  telling_ = {};
  if (server != nullptr) {
    telling_ = std::jthread([this, server](const std::stop_token& stop) {
      std::mutex unshared;
      std::unique_lock lock(unshared);
      std::condition_variable_any stopped;
      while (!stopped.wait_for(lock, stop, kHealthPause, [&] { return stop.stop_requested(); })) {
        server->SetServing(HealthNow().ready);
      }
    });
  }
  const std::lock_guard lock(mutex_);
  server_ = server;
  resources_ = std::move(resources);
  ended_ = server == nullptr;
}

double Operation::StateHangsFor() {
  return resources_.state == nullptr ? 0.0 : resources_.state->HangingSeconds();
}

std::string Operation::MetricsText() {
  const std::lock_guard lock(mutex_);
  std::vector<telemetry::Gauge> gauges{
      {"thunderhead_memory_bytes", "Memory that the process occupies", telemetry::ResidentBytes()},
      {"thunderhead_readers_abandoned",
       "Processes that read files and have not ended although they were killed",
       static_cast<double>(sandbox::AbandonedChildren())}};
  if (server_ != nullptr) {
    const service::ServerLoad load = server_->Load();
    const auto add = [&](const char* name, const char* help, double value) {
      gauges.push_back({absl::StrCat("thunderhead_", name), help, value});
    };
    add("sessions", "Sessions that are open", load.sessions);
    add("sessions_limit", "Sessions that may be open at once (--max-sessions)",
        static_cast<double>(load.max_sessions));
    add("viewers", "Connections of viewers to sessions", load.viewers);
    add("storms", "Storms in the catalogue", load.storms);
    add("storm_cache_bytes", "Fields of storms in memory", load.cached_bytes);
    add("pictures_in_progress", "Single images begun and not yet delivered", load.pictures);
    add("jobs", "Render jobs that have not ended", static_cast<double>(load.jobs.running));
    add("job_pictures_waiting", "Pictures of render jobs that wait to be drawn",
        static_cast<double>(load.jobs.waiting));
    add("job_pictures_paused",
        "Waiting pictures of render jobs that are not begun, because results must be fetched first",
        static_cast<double>(load.jobs.paused));
    add("job_pictures_in_progress", "Pictures of render jobs that are being drawn",
        static_cast<double>(load.jobs.drawing));
    add("job_result_bytes", "Bytes of render jobs' results on the disk",
        static_cast<double>(load.jobs.result_bytes));
    add("draining", "1 after SIGTERM, otherwise 0", load.draining ? 1.0 : 0.0);
    add("pictures_waiting", "Single images that wait to be drawn", load.waiting_pictures);
    add("reading_stuck_seconds",
        "Time since a storage that hangs last returned data; 0 if none hangs",
        load.reading_stuck_s);
    add("worker_stalled_seconds",
        "Time since a busy worker last drew a piece; 0 if no worker is busy or it waits for its "
        "turn",
        load.stalled_s);
    add("jobs_stalled_seconds",
        "Time for which the thread of render jobs has been at one task, or the folder of results "
        "has not answered",
        load.jobs.stalled_s);
    add("state_stuck_seconds", "Time for which the state folder has not answered; 0 if it answers",
        StateHangsFor());
    add("render_turn_seconds",
        "Time since the current turn of drawing began; 0 if nothing is drawn", load.turn_s);
  }
  AddBudget("memory_budget", resources_.memory.get(), gauges);
  AddBudget("gpu_memory_budget", resources_.gpu_memory.get(), gauges);
  return telemetry::Expose(telemetry::Counted(), gauges);
}

telemetry::Health Operation::HealthNow() {
  const std::lock_guard lock(mutex_);
  if (server_ == nullptr) {
    return {.alive = true, .ready = false, .state = ended_ ? "stopping" : "starting"};
  }
  const service::ServerLoad load = server_->Load();
  if (load.turn_s > flags_.stuck_s) {
    return {.alive = false,
            .ready = false,
            .state = absl::StrFormat("not making progress: drawing for %.0f s", load.turn_s)};
  }
  // The limit is long because a worker may read, fit or encode for minutes between two pieces.
  if (load.stalled_s > kWorkerFactor * flags_.stuck_s) {
    return {.alive = false,
            .ready = false,
            .state = absl::StrFormat("not making progress: a worker has drawn nothing for %.0f s",
                                     load.stalled_s)};
  }
  if (load.recovering) {
    return {.alive = true, .ready = false, .state = "the device was lost; opening it again"};
  }
  if (load.draining) return {.alive = true, .ready = false, .state = "draining"};
  // If a state folder or a disk of results hangs, restarting the process does not help, so the
  // process is reported as alive.
  if (const double hangs_s = StateHangsFor(); hangs_s > 0.0) {
    return {.alive = true,
            .ready = true,
            .state = absl::StrFormat("serving; the state folder has not answered for %.0f s, so "
                                     "neither sessions nor render jobs can be created",
                                     hangs_s)};
  }
  if (load.jobs.stalled_s > flags_.stuck_s) {
    return {.alive = true,
            .ready = true,
            .state = absl::StrFormat("serving; render jobs have made no progress for %.0f s",
                                     load.jobs.stalled_s)};
  }
  return {.alive = true, .ready = true, .state = "serving"};
}

std::jthread EndIfToldWhileStarting(const sigset_t& signals) {
  return std::jthread([signals](const std::stop_token& started) {
    while (!started.stop_requested()) {
      if (Taken(signals) == 0) continue;
      spdlog::info("stopped by a signal while starting: nothing is lost");
      spdlog::default_logger()->flush();
      _exit(0);
    }
  });
}

std::jthread EndAnywayAfter(std::chrono::seconds patience, const std::function<int()>& code,
                            const std::function<void()>& last) {
  return std::jthread([=](const std::stop_token& ended) {
    std::mutex unshared;
    std::unique_lock lock(unshared);
    std::condition_variable_any told;
    if (told.wait_for(lock, ended, patience, [&] { return ended.stop_requested(); })) return;
    spdlog::error(
        "calls have not ended for {} s, perhaps because their storage hangs: the process ends "
        "without them",
        patience.count());
    last();
    spdlog::default_logger()->flush();
    _exit(code());
  });
}

void Operation::WaitAndDrain(const sigset_t& signals, service::Server& server,
                             const std::function<void()>& last) {
  int signal = 0;
  sigwait(&signals, &signal);
  const auto began = steady_clock::now();
  spdlog::info(
      "draining: new sessions and pictures are refused, and {} pictures are finished first",
      server.Load().pictures);
  second_signal_ = std::jthread([signals, began, last](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const int again = Taken(signals);
      if (again == 0 || steady_clock::now() - began < kOneRequest) continue;
      spdlog::warn("a second signal came: the process ends at once");
      last();
      spdlog::default_logger()->flush();
      _exit(128 + again);
    }
  });
  server.BeginDrain();
  const auto grace = std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(flags_.drain_s));
  service::ServerLoad left = server.Load();
  while ((left.pictures > 0 || left.viewers > 0) && steady_clock::now() < began + grace) {
    std::this_thread::sleep_for(milliseconds(20));
    left = server.Load();
  }
  if (left.pictures > 0) {
    spdlog::warn("{} pictures are not finished after {} s and are cancelled", left.pictures,
                 flags_.drain_s);
  }
  if (left.viewers > 0) {
    spdlog::info("{} viewers have not left after {} s; their streams are ended", left.viewers,
                 flags_.drain_s);
  }
  spdlog::info("stopping");
}

}  // namespace thunderhead::app
