// The answer of a unary call, from when it is ready until its client has taken it. Meanwhile it
// counts as one of those that wait for its caller, and it has a deadline.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "absl/status/status.h"
#include "access/door.h"
#include "service/delivery_deadline.h"
#include "service/limits.h"

namespace thunderhead::service {

// Deletes itself when gRPC calls OnDone.
class Answer final : public grpc::ServerUnaryReactor {
 public:
  // `limits` must outlive it.
  Answer(grpc::CallbackServerContext* context, const Limits& limits,
         std::shared_ptr<const access::Caller> caller, const google::protobuf::Message& response)
      : caller_(std::move(caller)), response_(response), delivery_(context, limits) {}

  // Called once: ends the call with the response, which is complete, or with an error.
  void Give(absl::Status status);

  void OnDone() override { delete this; }

 private:
  const std::shared_ptr<const access::Caller> caller_;
  const google::protobuf::Message& response_;
  std::shared_ptr<const void> place_;
  DeliveryDeadline delivery_;
};

}  // namespace thunderhead::service
