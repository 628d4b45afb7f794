// The local socket through which the gateway and the command line reach the service in the same
// process. It accepts only connections of the process' user, and passes them to gRPC.
#pragma once

#include <grpcpp/server.h>

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "rpc_port/accept_loop.h"

namespace thunderhead::rpc_port {

class LocalListener {
 public:
  // Accepts connections for `server` until this object is destroyed. That must happen before the
  // server shuts down.
  static absl::StatusOr<std::unique_ptr<LocalListener>> Start(grpc::Server& server);

  // Returns the socket's address in the notation of gRPC's clients.
  const std::string& address() const { return address_; }

 private:
  LocalListener(std::string address, std::unique_ptr<AcceptLoop> loop)
      : address_(std::move(address)), loop_(std::move(loop)) {}

  const std::string address_;
  const std::unique_ptr<AcceptLoop> loop_;
};

}  // namespace thunderhead::rpc_port
