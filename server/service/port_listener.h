// gRPC's TCP port. gRPC's own listens without a limit on connections, and those that say nothing
// would use up the process's file descriptors.
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
#include "service/accept_loop.h"
#include "service/open_sockets.h"

namespace thunderhead::service {

class PortListener {
 public:
  using Acceptor = std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor>;
  // Told of a newcomer that was closed, and why; on the listener's thread.
  using Refused = std::function<void(const std::string& peer, const absl::Status& why)>;

  struct Options {
    std::chrono::milliseconds unused;     // those without a call for so long are closed
    double handshakes_per_address = 0.0;  // as Limits has it; 0: no limit
    base::TrustedProxies proxies;         // which have none
    const base::TimeSource* time = &base::SteadyTime();  // must outlive the listener
  };

  // Listens on "HOST:PORT", port 0 for a free one; connections wait until Start. 0.0.0.0 and [::]
  // are all of this machine's addresses, of IPv4 and IPv6. What has been sent on a connection must
  // arrive within `unanswered`. UNAVAILABLE if it cannot.
  static absl::StatusOr<std::unique_ptr<PortListener>> Open(const std::string& address,
                                                            std::chrono::milliseconds unanswered);

  int Port() const { return port_; }

  // Hands connections to `acceptor` until this is destroyed, which must be before its server shuts
  // down.
  absl::Status Start(Acceptor acceptor, OpenSockets open, const Options& options, Refused refused);

 private:
  PortListener(std::vector<base::FileDescriptor> sockets, int port)
      : sockets_(std::move(sockets)), port_(port) {}

  std::vector<base::FileDescriptor> sockets_;  // until Start
  const int port_;
  std::unique_ptr<AcceptLoop> loop_;
};

}  // namespace thunderhead::service
