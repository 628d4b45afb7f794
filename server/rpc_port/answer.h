// The response of a unary call, from when it is ready until the client has received it. Meanwhile
// it counts as one of the caller's pending responses and has a deadline.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <cstddef>
#include <memory>

#include "absl/status/status.h"
#include "access/access_control.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/port_limits.h"

namespace thunderhead::rpc_port {

// Returns the memory in bytes that a message occupies until its client has received it. It includes
// the message's copy in the wire format, which gRPC sends.
std::size_t UnreadBytes(const google::protobuf::Message& message);

// The reactor that sends a response. It deletes itself when gRPC calls OnDone.
class Answer final : public grpc::ServerUnaryReactor {
 public:
  // Creates the reactor. `limits` must outlive it.
  Answer(grpc::CallbackServerContext* context, const PortLimits& limits,
         std::shared_ptr<const access::Caller> caller, const google::protobuf::Message& response)
      : caller_(std::move(caller)), response_(response), delivery_(context, limits) {}

  // Ends the call with the response, which must be complete, or with an error. Must be called
  // exactly once.
  void Give(absl::Status status);

  void OnDone() override { delete this; }

 private:
  const std::shared_ptr<const access::Caller> caller_;
  const google::protobuf::Message& response_;
  std::shared_ptr<const void> place_;
  DeliveryDeadline delivery_;
};

}  // namespace thunderhead::rpc_port
