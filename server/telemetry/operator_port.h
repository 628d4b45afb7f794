// The operator's port: HTTP for Prometheus and for supervisors that restart servers. It answers all
// clients concurrently, each within seconds, on a separate thread. A client that sends nothing does
// not block others.
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
  // Returns whether this server answers to the name in a Host header. If empty, it answers to any
  // name. The check prevents DNS rebinding, in which a foreign web site makes its name lead here.
  std::function<bool(std::string_view host)> allows_host;
};

class OperatorPort {
 public:
  // The longest time that a client may take to send its request and receive the response.
  static constexpr std::chrono::seconds kPatience{2};

  // Serves GET /metrics, /healthz and /readyz on that address. Port 0 means a free port. A client
  // that takes longer than `patience` is disconnected. Returns UNAVAILABLE if it cannot listen on
  // the address.
  static absl::StatusOr<std::unique_ptr<OperatorPort>> Open(
      const std::string& host, std::uint16_t port, OperatorPages pages,
      std::chrono::milliseconds patience = kPatience);
  virtual ~OperatorPort() = default;

  virtual std::uint16_t Port() const = 0;
};

}  // namespace thunderhead::telemetry
