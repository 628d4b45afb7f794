// The HTTP port for operators: for Prometheus, and for supervisors that restart servers. One
// separate thread serves all clients concurrently, and disconnects a client that takes too long. A
// client that sends nothing does not block others.
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
  bool alive = true;  // result of /healthz; false requests a restart
  bool ready = true;  // result of /readyz; false requests that clients are sent to another server
  std::string state;  // description of the state in one line
};

struct OperatorPages {
  std::function<std::string()> metrics;  // in Prometheus's text format
  std::function<Health()> health;
  // Returns whether the server accepts requests with the name `host` in the Host header. If empty,
  // it accepts every name. The check prevents DNS rebinding, in which a foreign web site makes its
  // own name resolve to this server's address.
  std::function<bool(std::string_view host)> allows_host;
};

class OperatorPort {
 public:
  // The longest time that a client may take to send its request and receive the response.
  static constexpr std::chrono::seconds kPatience{2};

  // Serves GET /metrics, /healthz and /readyz on the address `host` and `port`. Port 0 means a free
  // port. A client that takes longer than `patience` is disconnected. Returns UNAVAILABLE if the
  // server cannot listen on the address.
  static absl::StatusOr<std::unique_ptr<OperatorPort>> Open(
      const std::string& host, std::uint16_t port, OperatorPages pages,
      std::chrono::milliseconds patience = kPatience);
  virtual ~OperatorPort() = default;

  virtual std::uint16_t Port() const = 0;
};

}  // namespace thunderhead::telemetry
