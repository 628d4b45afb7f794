// The operator's port: HTTP for Prometheus and for whoever restarts servers. Answers all that ask
// at once, each within seconds, on a thread of its own; who says nothing holds up nobody.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::telemetry {

struct Health {
  bool alive = true;  // /healthz: false asks for a restart
  bool ready = true;  // /readyz: false asks for clients to be sent elsewhere
  std::string state;  // for people, one line
};

struct OperatorPages {
  std::function<std::string()> metrics;  // in Prometheus's text format
  std::function<Health()> health;
  // Whether this server answers to the name of a Host header; empty: to any. A foreign web site may
  // have a name of its own lead here (DNS rebinding).
  std::function<bool(std::string_view host)> allows_host;
};

class OperatorPort {
 public:
  // The longest time that a client may take to ask and to listen.
  static constexpr std::chrono::seconds kPatience{2};

  // GET /metrics, /healthz and /readyz on that address, port 0 for a free one. A client that takes
  // longer than `patience` is cut off. UNAVAILABLE if the address cannot be listened on.
  static absl::StatusOr<std::unique_ptr<OperatorPort>> Open(
      const std::string& host, std::uint16_t port, OperatorPages pages,
      std::chrono::milliseconds patience = kPatience);
  virtual ~OperatorPort() = default;

  virtual std::uint16_t Port() const = 0;
};

}  // namespace thunderhead::telemetry
