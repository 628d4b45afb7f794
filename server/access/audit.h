// The audit log: one line for each refusal and each privileged act. It is for people who
// investigate incidents and for programs that raise alarms. It never contains a token or a
// session's key.
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
  std::string identity;  // empty: unknown
  std::string role;      // empty: unknown
  std::string peer;
  std::string name;  // name of the call, or of the act within a call
  // True if the gateway refused a request before there was a call.
  bool before_call = false;
};

class Audit {
 public:
  using Clock = std::chrono::system_clock;

  // Maximum number of refusals written per second. Further ones are only counted, because a flood
  // must not fill the disk. The count is in the next line of a refusal. Refusals before a call have
  // a separate limit, so that a flood of connections does not hide attempts with wrong tokens.
  // Allowed acts are always written.
  static constexpr int kMaxRefusalsPerSecond = 50;

  // Waits up to the given time until all lines are written.
  using FlushLines = std::function<void(std::chrono::milliseconds)>;

  // `write` takes one line without its end, from any thread, one at a time. It may write the line
  // later. `flush`, if there is one, waits for that.
  explicit Audit(std::function<void(const std::string&)> write, FlushLines flush = nullptr)
      : write_(std::move(write)), flush_(std::move(flush)) {}

  // Writes an act with its outcome `status`, which is "allowed" if OK. The reason is written, but
  // not the message, because the message may repeat what the client sent.
  void Write(const Act& act, const absl::Status& status, Clock::time_point now = Clock::now());
  // Waits up to `time` until everything reported is written. Safe from any thread.
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
