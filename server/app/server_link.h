// A running server as commands call it: --server with what it asks for, one channel, and errors as
// statuses.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "app/client_access.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/support/status.h"
#include "thunderhead/v1/job.grpc.pb.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::app {

struct ServerFlags {
  std::string address;  // HOST:PORT; empty: no server
  ClientAccessFlags access;
};

void AddServerFlags(CLI::App& command, ServerFlags& flags);

class ServerLink {
 public:
  // INVALID_ARGUMENT names the flag that is wrong. Does not wait for the server.
  static absl::StatusOr<std::unique_ptr<ServerLink>> Open(const ServerFlags& flags);

  v1::ThunderheadService::Stub& Service() { return *service_; }
  v1::RenderJobService::Stub& Jobs() { return *jobs_; }
  const std::shared_ptr<grpc::Channel>& Channel() const { return channel_; }
  const std::string& Token() const { return token_; }
  const std::string& Address() const { return address_; }

  // Calls a unary rpc with the token: Call(&Stub::ListStorms of Service(), ...). A server that does
  // not answer is UNAVAILABLE after a while.
  template <typename Stub, typename Method, typename Request, typename Response>
  absl::Status Call(Stub& stub, Method method, const Request& request, Response* response) {
    grpc::ClientContext context;
    Prepare(context);
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    return StatusOf((stub.*method)(&context, request, response));
  }

  // Shows the token.
  void Prepare(grpc::ClientContext& context) const;

  // The same code and message; the server's name with those of a lost connection.
  absl::Status StatusOf(const grpc::Status& status) const;

 private:
  // A server may have to read a storm first.
  static constexpr std::chrono::seconds kPatience{120};

  ServerLink(std::string address, std::string token, std::shared_ptr<grpc::Channel> channel);

  const std::string address_;
  const std::string token_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::ThunderheadService::Stub> service_;
  const std::unique_ptr<v1::RenderJobService::Stub> jobs_;
};

}  // namespace thunderhead::app
