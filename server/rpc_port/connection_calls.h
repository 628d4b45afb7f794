// Reports which connections to gRPC's port are in use, which means that they have an admitted call.
// gRPC reports neither its connections nor the connection of a call. However, a call's peer is the
// remote address and port of its connection, which no two open connections share. Safe to call from
// any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/time_source.h"

namespace thunderhead::rpc_port {

class ConnectionCalls {
 public:
  using Clock = std::chrono::steady_clock;

  // `time` must outlive this object and the results of Begin.
  explicit ConnectionCalls(const base::TimeSource& time = base::SteadyTime())
      : shared_(std::make_shared<Shared>(time)) {}

  struct Use {
    std::size_t calls = 0;      // calls in progress
    Clock::time_point since{};  // when the last call began or ended
  };

  // Counts a call of the connection with this peer, such as "1.2.3.4:80" or "[::1]:80". The call
  // counts until the last copy of the result is destroyed. The result may outlive this object.
  std::shared_ptr<const void> Begin(const std::string& peer);
  // Returns the use of a connection, or nothing if it never had a call.
  std::optional<Use> UseOf(const std::string& peer) const;
  // Forgets a connection that was closed, or whose peer now belongs to a new connection.
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

}  // namespace thunderhead::rpc_port
