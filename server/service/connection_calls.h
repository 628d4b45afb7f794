// Which connections of gRPC's port are used: those with a call that the door let in. gRPC tells
// neither of its connections nor which a call is of, but a call's peer is its connection's other
// end, which no two have at a time. Safe from any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/time_source.h"

namespace thunderhead::service {

class ConnectionCalls {
 public:
  using Clock = std::chrono::steady_clock;

  // `time` must outlive it and the calls.
  explicit ConnectionCalls(const base::TimeSource& time = base::SteadyTime())
      : shared_(std::make_shared<Shared>(time)) {}

  struct Use {
    std::size_t calls = 0;      // now
    Clock::time_point since{};  // when the last of them began or ended
  };

  // Counts a call of that peer's connection, "1.2.3.4:80" or "[::1]:80", until the last copy is
  // destroyed, which may outlive this.
  std::shared_ptr<const void> Begin(const std::string& peer);
  // Nothing for one that never had a call.
  std::optional<Use> UseOf(const std::string& peer) const;
  // The connection is closed, or a new one.
  void Forget(const std::string& peer);

 private:
  struct Shared {
    explicit Shared(const base::TimeSource& by) : time(by) {}

    const base::TimeSource& time;
    std::mutex mutex;
    std::map<std::string, std::shared_ptr<Use>> uses;
  };

  const std::shared_ptr<Shared> shared_;
};

}  // namespace thunderhead::service
