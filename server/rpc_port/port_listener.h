// The TCP port of the gRPC server. gRPC's own listener does not limit the number of connections, so
// idle connections could use up the process's file descriptors. This listener limits the number.
#pragma once

#include <grpcpp/server_builder.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/time_source.h"
#include "base/trusted_proxies.h"
#include "rpc_port/accept_loop.h"
#include "rpc_port/call_budgets.h"
#include "rpc_port/open_sockets.h"

namespace thunderhead::rpc_port {

class PortListener {
 public:
  using Acceptor = std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor>;
  // Called on the listener's thread when a new connection from `peer` was refused because of `why`,
  // and when the connections of its network were closed because of `why`.
  using Refused = std::function<void(const std::string& peer, const absl::Status& why)>;

  struct Options {
    std::chrono::milliseconds unused;     // timeout of connections without a call
    double handshakes_per_address = 0.0;  // as PortLimits::max_handshakes_per_address
    std::shared_ptr<CallBudgets> calls;   // counts the calls of the port
    // Addresses to which the limits per address do not apply.
    base::TrustedProxies proxies;
    const base::TimeSource* time = &base::SteadyTime();  // must outlive the listener
  };

  // Listens on "HOST:PORT"; port 0 picks a free port. Connections wait until Start. The hosts
  // 0.0.0.0 and [::] mean all addresses of this machine, both IPv4 and IPv6. If a peer does not
  // acknowledge sent data within `unanswered`, its connection is closed. Returns UNAVAILABLE if
  // listening fails.
  static absl::StatusOr<std::unique_ptr<PortListener>> Open(const std::string& address,
                                                            std::chrono::milliseconds unanswered);

  int Port() const { return port_; }

  // Passes connections to `acceptor` until this object is destroyed. It must be destroyed before
  // the gRPC server shuts down.
  absl::Status Start(Acceptor acceptor, OpenSockets open, const Options& options, Refused refused);

 private:
  PortListener(std::vector<base::FileDescriptor> sockets, int port)
      : sockets_(std::move(sockets)), port_(port) {}

  std::vector<base::FileDescriptor> sockets_;  // held until Start
  const int port_;
  std::unique_ptr<AcceptLoop> loop_;
};

}  // namespace thunderhead::rpc_port
