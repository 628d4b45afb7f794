// Lets a call in, or not: finds in its metadata what the client shows, and asks the door.
#pragma once

#include <grpcpp/server_context.h>

#include <memory>

#include "absl/status/statusor.h"
#include "access/door.h"

namespace thunderhead::service {

using CallerOr = absl::StatusOr<std::shared_ptr<const access::Caller>>;

// By the header "authorization: Bearer TOKEN" and the client's address, which for calls of the
// gateway is the browser's.
CallerOr Admit(access::Door& door, const grpc::CallbackServerContext& context, const char* method,
               access::CallKind kind);

}  // namespace thunderhead::service
