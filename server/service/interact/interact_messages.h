// Serializes the responses of Interact, as bytes that all people of a session share. The requests
// are in interact_requests.h.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "session/audience.h"
#include "session/sessions.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Returns the functions with which session::Audience serializes its updates as whole responses.
session::AudienceFormat InteractFormat();
// Serializes a frame for drawing::FrameEncoder, without the sequence number, which the hub assigns
// later.
std::string SerializedFrame(const delivery::EncodedFrame& frame);

// Serialize responses. Responses with a frame or a scene share the bytes of that part.
grpc::ByteBuffer FrameResponse(const std::shared_ptr<const delivery::EncodedFrame>& frame,
                               bool own_view);
grpc::ByteBuffer SceneResponse(const session::NewestScene& scene);
grpc::ByteBuffer ResponseOf(const v1::InteractResponse& response);
// Returns the last message of a call.
v1::InteractResponse EndResponse(const absl::Status& why);
// Returns the response that reports a refused request.
v1::InteractResponse RefusedResponse(std::uint64_t request_id, const absl::Status& why);

v1::Role RoleMessage(session::Role role);

void ToMessage(const session::Rules& rules, v1::SessionRules& message);
void ToMessage(const session::Mark& mark, v1::Mark& message);

}  // namespace thunderhead::service
