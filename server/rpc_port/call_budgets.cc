#include "rpc_port/call_budgets.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/client_network.h"
#include "rpc_port/connection_of.h"

namespace thunderhead::rpc_port {
namespace {

constexpr std::chrono::seconds kBlocked{1};

class CallCounter final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit CallCounter(std::shared_ptr<CallBudgets> budgets) : budgets_(std::move(budgets)) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* call) override {
    const std::optional<std::string> connection = ConnectionOf(*call->server_context());
    if (connection.has_value()) budgets_->Begin(*connection);
    budgets_->EndWaiting();
    return nullptr;
  }

 private:
  const std::shared_ptr<CallBudgets> budgets_;
};

class ReceivedCounter final : public grpc::ContextAllocator {
 public:
  explicit ReceivedCounter(std::shared_ptr<CallBudgets> budgets) : budgets_(std::move(budgets)) {}

  grpc::CallbackServerContext* NewCallbackServerContext() override {
    budgets_->Receive();
    return nullptr;
  }
  grpc::GenericCallbackServerContext* NewGenericCallbackServerContext() override {
    budgets_->Receive();
    return nullptr;
  }

 private:
  const std::shared_ptr<CallBudgets> budgets_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<CallBudgets>> CallBudgets::Open(double per_second,
                                                               base::TrustedProxies proxies,
                                                               const base::TimeSource& time) {
  base::FileDescriptor signal(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!signal.IsOpen()) {
    return absl::UnavailableError(absl::StrCat("cannot count calls: ", strerror(errno)));
  }
  return std::shared_ptr<CallBudgets>(
      new CallBudgets(per_second, std::move(proxies), time, std::move(signal)));
}

void CallBudgets::Begin(const std::string& peer) {
  if (proxies_.Holds(peer)) return;
  const std::string network = base::NetworkOf(peer);
  const std::lock_guard lock(mutex_);
  const Time now = time_.Now();
  if (!budgets_.Take(network, now).has_value()) return;
  Time& until = blocked_until_[network];
  const bool was_blocked = now < until;
  until = now + kBlocked;
  if (was_blocked) return;
  newly_blocked_.push_back(peer);
  Notify();
}

void CallBudgets::Receive() {
  constexpr std::int64_t kNotifyEvery = 512;
  const std::int64_t waiting = ++waiting_;
  if (waiting > kMostWaiting && waiting % kNotifyEvery == 0) Notify();
}

void CallBudgets::Block(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  blocked_until_[base::NetworkOf(peer)] = time_.Now() + kBlocked;
}

void CallBudgets::Notify() const {
  const std::uint64_t one = 1;
  (void)!write(signal_.Get(), &one, sizeof(one));
}

bool CallBudgets::IsBlocked(const std::string& peer) const {
  const std::lock_guard lock(mutex_);
  const auto until = blocked_until_.find(base::NetworkOf(peer));
  return until != blocked_until_.end() && time_.Now() < until->second;
}

std::vector<std::string> CallBudgets::TakeNewlyBlocked() {
  const std::lock_guard lock(mutex_);
  std::uint64_t count = 0;
  (void)!read(signal_.Get(), &count, sizeof(count));
  std::erase_if(blocked_until_,
                [now = time_.Now()](const auto& blocked) { return now >= blocked.second; });
  return std::exchange(newly_blocked_, {});
}

std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface> CountCalls(
    std::shared_ptr<CallBudgets> budgets) {
  return std::make_unique<CallCounter>(std::move(budgets));
}

std::unique_ptr<grpc::ContextAllocator> CountReceived(std::shared_ptr<CallBudgets> budgets) {
  return std::make_unique<ReceivedCounter>(std::move(budgets));
}

}  // namespace thunderhead::rpc_port
