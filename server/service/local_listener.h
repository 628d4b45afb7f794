// The socket by which the gateway and the command line reach the service in their own process. It
// accepts connections of this process' user alone, and hands them to gRPC.
#pragma once

#include <grpcpp/server.h>

#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"

namespace thunderhead::service {

class LocalListener {
 public:
  // Accepts connections for `server` until it is destroyed, which must be before the server shuts
  // down.
  static absl::StatusOr<std::unique_ptr<LocalListener>> Start(grpc::Server& server);
  ~LocalListener();
  LocalListener(const LocalListener&) = delete;
  LocalListener& operator=(const LocalListener&) = delete;

  // Its address as gRPC's clients write it.
  const std::string& address() const { return address_; }

 private:
  LocalListener(grpc::Server& server, std::string address, int socket, int stop)
      : server_(server), address_(std::move(address)), socket_(socket), stop_(stop) {}
  void Accept();

  grpc::Server& server_;
  const std::string address_;
  const int socket_;
  const int stop_;  // an eventfd
  std::thread thread_;
};

}  // namespace thunderhead::service
