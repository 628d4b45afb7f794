// A running server, as commands call it: one gRPC channel, and errors as absl::Status.
#pragma once

#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/support/status.h"
#include "thunderhead/v1/job.grpc.pb.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::runs {

struct ServerPlace {
  std::string address;    // HOST:PORT
  std::string token;      // the access token; empty for none
  std::string tls_roots;  // PEM text of the certificates to trust; empty for no TLS
  // While calls are open, the connection is tested this often. Without an answer within the
  // timeout, it is closed, and its calls end with UNAVAILABLE. A server or a network that vanishes
  // would otherwise not be noticed. Servers permit one ping in 10 s.
  std::chrono::milliseconds ping_interval = std::chrono::seconds(20);
  std::chrono::milliseconds ping_timeout = std::chrono::seconds(10);
};

// Returns true for the errors of a call that may succeed later, because the server is restarting,
// cannot be reached or answers slowly.
bool MayComeBack(const absl::Status& status);

class ServerLink {
 public:
  // Creates the link without waiting for the server.
  explicit ServerLink(const ServerPlace& place);

  v1::ThunderheadService::Stub& Service() { return *service_; }
  v1::RenderJobService::Stub& Jobs() { return *jobs_; }
  const std::shared_ptr<grpc::Channel>& Channel() const { return channel_; }
  const std::string& Token() const { return token_; }
  const std::string& Address() const { return address_; }

  // If `stop` is requested, the calls that begin after StopOn are cancelled.
  void StopOn(std::stop_token stop) { stop_ = std::move(stop); }

  // Calls a unary rpc with the token, for example Call(Service(), &Stub::ListStorms, ...). Returns
  // UNAVAILABLE if the server cannot be reached, DEADLINE_EXCEEDED if it does not respond within
  // kPatience, and CANCELLED if a stop is requested.
  template <typename Stub, typename Method, typename Request, typename Response>
  absl::Status Call(Stub& stub, Method method, const Request& request, Response* response) {
    grpc::ClientContext context;
    Prepare(context);
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    const std::stop_callback cancel(stop_, [&context] { context.TryCancel(); });
    return StatusOf((stub.*method)(&context, request, response));
  }

  // Adds the access token to the call.
  void Prepare(grpc::ClientContext& context) const;

  // Converts a gRPC status to one with the same code and message. For UNAVAILABLE, the message also
  // says that the server cannot be reached, and for DEADLINE_EXCEEDED that it has not answered in
  // time. For UNIMPLEMENTED, the message says that the versions differ. Any error becomes CANCELLED
  // once a stop is requested.
  absl::Status StatusOf(const grpc::Status& status) const;

 private:
  // The timeout is long because a server may have to read a storm first.
  static constexpr std::chrono::seconds kPatience{120};

  std::stop_token stop_;
  const std::string address_;
  const std::string token_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::ThunderheadService::Stub> service_;
  const std::unique_ptr<v1::RenderJobService::Stub> jobs_;
};

}  // namespace thunderhead::runs
