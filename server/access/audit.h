// The audit log, with one line for each refused call and each privileged act. It is for operators
// who investigate incidents and for programs that raise alarms. It never contains a token or a
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
  std::string identity;  // empty if unknown
  std::string role;      // empty if unknown
  std::string peer;
  std::string name;  // name of the call, or of the act within a call
  // True if the gateway refused a request before it became a call of the service.
  bool before_call = false;
};

class Audit {
 public:
  using Clock = std::chrono::system_clock;

  // Maximum number of refusals written per second. Further refusals are only counted, because a
  // flood of requests must not fill the disk. The next line of a refusal contains the count.
  // Refusals before a call (Act::before_call) have a separate limit, so that a flood of connections
  // does not hide calls with wrong tokens. Allowed acts are always written.
  static constexpr int kMaxRefusalsPerSecond = 50;

  // Waits up to the given time until all lines are written.
  using FlushLines = std::function<void(std::chrono::milliseconds)>;

  // `write` receives one line without a newline. It is called on any thread, but only once at a
  // time. If it writes lines later, `flush` must wait until they are written.
  explicit Audit(std::function<void(const std::string&)> write, FlushLines flush = nullptr)
      : write_(std::move(write)), flush_(std::move(flush)) {}

  // Writes an act and its outcome `status`. The line contains "allowed" if `status` is OK, and
  // otherwise "refused" with the error's reason. It does not contain the error's message, because
  // the message may repeat text that the client sent.
  void Write(const Act& act, const absl::Status& status, Clock::time_point now = Clock::now());
  // Waits up to `time` until all lines passed to Write are written. Safe from any thread.
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
