// The audit: one line for each refusal and each privileged act, for people who look into what
// happened and programs that raise alarms. A token or a session's key is never in it.
//
//   audit time=2026-01-02T03:04:05.678Z identity="anna" role=presenter peer="192.0.2.7:51234"
//   act=CreateSession verdict=allowed reason="" (on one line)
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "access/identity.h"
#include "base/line_limit.h"

namespace thunderhead::access {

struct Act {
  std::string identity;  // empty: nobody known
  std::string role;      // empty: likewise
  std::string peer;
  std::string name;  // of the call, or of what was asked for within one
  // Refused by the gateway before there was a call.
  bool before_call = false;
};

class Audit {
 public:
  using Clock = std::chrono::system_clock;

  // Refusals in one second beyond these are counted, not written: a flood must not fill the disk.
  // The count is in the next line of a refusal. Those before a call are limited by themselves, so
  // that a flood of connections does not hide who tries tokens. What was allowed is always written.
  static constexpr int kMaxRefusalsPerSecond = 50;

  // Waits at most that long until all lines are written.
  using FlushLines = std::function<void(std::chrono::milliseconds)>;

  // `write` takes one line without its end, from any thread, one at a time; it may write later,
  // which `flush`, if there is one, waits for.
  explicit Audit(std::function<void(const std::string&)> write, FlushLines flush = nullptr)
      : write_(std::move(write)), flush_(std::move(flush)) {}

  // `status` is the act's outcome: allowed if OK. Its reason is written, not its message, which may
  // repeat what the client sent.
  void Write(const Act& act, const absl::Status& status, Clock::time_point now = Clock::now());
  // Waits at most that long until everything reported is written; from any thread.
  void Flush(std::chrono::milliseconds time) const {
    if (flush_ != nullptr) flush_(time);
  }

 private:
  std::mutex mutex_;
  const std::function<void(const std::string&)> write_;
  const FlushLines flush_;
  base::LineLimit calls_{kMaxRefusalsPerSecond};
  base::LineLimit before_calls_{kMaxRefusalsPerSecond};
};

}  // namespace thunderhead::access
