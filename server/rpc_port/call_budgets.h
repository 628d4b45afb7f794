// Limits how many calls per second each client network begins on gRPC's port. HTTP/2's limit of
// concurrent calls does not bound them, because a client may reset each call at once. Such a flood
// would take all memory: gRPC keeps the memory of a reset call until its handler has run.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_interceptor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "base/allowance.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"
#include "base/trusted_proxies.h"

namespace thunderhead::rpc_port {

// Counts the calls of each IPv4 address or IPv6 network (/64). All methods may be called from any
// thread.
class CallBudgets {
 public:
  // Each network may begin `per_second` calls per second, with bursts of twice as many; 0 means no
  // limit. Addresses in `proxies` have no limit. `time` must outlive the object. Returns
  // UNAVAILABLE without a free file descriptor.
  static absl::StatusOr<std::shared_ptr<CallBudgets>> Open(double per_second,
                                                           base::TrustedProxies proxies,
                                                           const base::TimeSource& time);

  // Receive() counts a call whose handler has not begun yet, and EndWaiting() ends that. gRPC's few
  // threads read connections before they run handlers. A flood of calls can therefore keep all
  // handlers waiting.
  void Receive();
  void EndWaiting() { --waiting_; }
  // Returns whether so many calls wait for their handlers that their memory is a danger. The
  // network that sends most must then be blocked.
  bool HasBacklog() const { return waiting_ > kMostWaiting; }

  // Counts a call that begins on the connection with this peer, such as "1.2.3.4:80". If its
  // network has exceeded its budget, the network is blocked until one second after its last such
  // call.
  void Begin(const std::string& peer);
  bool IsBlocked(const std::string& peer) const;
  // Blocks the network of this peer for one second.
  void Block(const std::string& peer);
  // Returns one peer of each network that was blocked since the last call of this method. Its
  // connections must be closed.
  std::vector<std::string> TakeNewlyBlocked();
  // Returns a descriptor that is readable when TakeNewlyBlocked() has something to return, and when
  // HasBacklog() is true and calls were received since then.
  int Signal() const { return signal_.Get(); }

 private:
  // Maximum number of calls that wait for their handlers. Each takes about 17 kB of memory.
  static constexpr std::int64_t kMostWaiting = 4096;

  using Time = base::TimeSource::Clock::time_point;

  void Notify() const;

  CallBudgets(double per_second, base::TrustedProxies proxies, const base::TimeSource& time,
              base::FileDescriptor signal)
      : proxies_(std::move(proxies)),
        time_(time),
        signal_(std::move(signal)),
        budgets_(per_second) {}

  const base::TrustedProxies proxies_;
  const base::TimeSource& time_;
  const base::FileDescriptor signal_;  // an eventfd
  std::atomic<std::int64_t> waiting_ = 0;
  mutable std::mutex mutex_;
  base::Allowances budgets_;
  std::map<std::string, Time> blocked_until_;  // by network
  std::vector<std::string> newly_blocked_;
};

// Returns a factory with which gRPC's server tells `budgets` each call that begins, of known and of
// unknown methods. The calls get no interceptor.
std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> CountCalls(
    std::shared_ptr<CallBudgets> budgets);

// Returns the object by which gRPC's server tells `budgets` each call that it has received. gRPC
// itself allocates the contexts. All services must use callbacks, because gRPC tells nothing of
// other calls.
std::unique_ptr<grpc::ContextAllocator> CountReceived(std::shared_ptr<CallBudgets> budgets);

}  // namespace thunderhead::rpc_port
