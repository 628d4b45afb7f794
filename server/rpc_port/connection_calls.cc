#include "rpc_port/connection_calls.h"

namespace thunderhead::rpc_port {

std::shared_ptr<const void> ConnectionCalls::Begin(const std::string& peer) {
  const std::lock_guard lock(shared_->mutex);
  std::shared_ptr<Use>& use = shared_->uses[peer];
  if (use == nullptr) use = std::make_shared<Use>();
  ++use->calls;
  use->since = shared_->time.Now();
  return {use.get(), [shared = shared_, use](const Use*) {
            const std::lock_guard ending(shared->mutex);
            --use->calls;
            use->since = shared->time.Now();
          }};
}

std::optional<ConnectionCalls::Use> ConnectionCalls::UseOf(const std::string& peer) const {
  const std::lock_guard lock(shared_->mutex);
  const auto use = shared_->uses.find(peer);
  if (use == shared_->uses.end()) return std::nullopt;
  return *use->second;
}

void ConnectionCalls::Forget(const std::string& peer) {
  const std::lock_guard lock(shared_->mutex);
  shared_->uses.erase(peer);
}

}  // namespace thunderhead::rpc_port
