// Admits calls: reads the client's credentials from a call's metadata and asks the access control
// (access::AccessControl) whether the call is allowed.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "access/access_control.h"
#include "rpc_port/connection_calls.h"
#include "rpc_port/finished.h"

namespace thunderhead::rpc_port {

using CallerOr = absl::StatusOr<std::shared_ptr<const access::Caller>>;

// Admits a call by its header "authorization: Bearer TOKEN" and the client's address. The gateway
// and trusted proxies report the address of their client, which is used instead of their own.
CallerOr Admit(access::AccessControl& access_control, const grpc::CallbackServerContext& context,
               const char* method, access::CallKind kind);

// The entry point of one service. Each call is either handled or refused. If a handler throws an
// exception, the call ends with INTERNAL.
class Entrance {
 public:
  // If `closed` is not OK, it is the error of every call that the access control admits. `calls`
  // counts the admitted calls of each connection.
  Entrance(access::AccessControl& access_control, ConnectionCalls& calls,
           absl::Status closed = absl::OkStatus())
      : access_control_(access_control), calls_(calls), closed_(std::move(closed)) {}

  // Handles a unary call. `handle` takes the caller and returns the call's reactor.
  template <typename Handler>
  grpc::ServerUnaryReactor* Unary(const char* method, grpc::CallbackServerContext* context,
                                  const Handler& handle) const {
    const CallerOr caller = Enter(*context, method, access::CallKind::kUnary);
    if (!caller.ok()) return Refused(context, caller.status());
    const auto reactor = base::Guarded(
        [&]() -> absl::StatusOr<grpc::ServerUnaryReactor*> { return handle(*caller); });
    return reactor.ok() ? *reactor : Refused(context, **caller, reactor.status());
  }

  template <typename Reactor, typename Handler>
  Reactor* Stream(const char* method, grpc::CallbackServerContext* context,
                  const Handler& handle) const {
    CallerOr caller = Enter(*context, method, access::CallKind::kStream);
    if (!caller.ok()) return new RefusedStream<Reactor>(caller.status());
    const std::shared_ptr<const access::Caller> known = *caller;
    const auto reactor =
        base::Guarded([&]() -> absl::StatusOr<Reactor*> { return handle(*std::move(caller)); });
    return reactor.ok() ? *reactor : new RefusedStream<Reactor>(*known, reactor.status());
  }

 private:
  CallerOr Enter(const grpc::CallbackServerContext& context, const char* method,
                 access::CallKind kind) const;

  access::AccessControl& access_control_;
  ConnectionCalls& calls_;
  const absl::Status closed_;
};

}  // namespace thunderhead::rpc_port
