// The open connections, and the choice of the connection that is closed to make place for a new
// one. Runs on one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_set>
#include <utility>

#include "base/time_source.h"
#include "base/trusted_proxies.h"
#include "gateway/client_link.h"

namespace thunderhead::gateway {

class OpenLinks {
 public:
  // Only `most` limits the connections of addresses in `proxies`. `time` must outlive this object.
  OpenLinks(size_t most, size_t most_per_address, base::TrustedProxies proxies,
            const base::TimeSource& time)
      : most_(most),
        most_per_address_(most_per_address),
        proxies_(std::move(proxies)),
        time_(time) {}

  // If the maximum number of connections is reached, closes another connection for `newcomer`.
  // Returns false if no connection can be closed.
  bool MakeRoom(const ClientLink& newcomer);
  void Add(const std::shared_ptr<ClientLink>& link) { links_.insert(link); }
  void Remove(const std::shared_ptr<ClientLink>& link) { links_.erase(link); }
  void StopAll();

 private:
  // Closes one connection of that network, or of any network if `network` is null.
  bool CloseLeastNeeded(const std::string* network);
  void TellOfRefusal(const ClientLink& newcomer);

  const size_t most_;
  const size_t most_per_address_;
  const base::TrustedProxies proxies_;
  const base::TimeSource& time_;
  std::unordered_set<std::shared_ptr<ClientLink>> links_;
  ClientLink::Clock::time_point told_at_{};
  uint64_t untold_ = 0;
};

}  // namespace thunderhead::gateway
