// The responses of Interact, as bytes that all people of a session share. Its requests are in
// interact_requests.h.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "session/audience.h"
#include "session/sessions.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Returns the functions that serialize whole responses, for session::Audience.
session::AudienceFormat InteractFormat();
// Returns a frame's message without its sequence number, for session::FrameEncoder.
std::string SerializedFrame(const delivery::EncodedFrame& frame);

// Serializes responses. Responses with frames and scenes share the bytes of their largest part.
grpc::ByteBuffer FrameResponse(const std::shared_ptr<const delivery::EncodedFrame>& frame,
                               bool own_view);
grpc::ByteBuffer SceneResponse(const session::NewestScene& scene);
grpc::ByteBuffer ResponseOf(const v1::InteractResponse& response);
// Returns the last message of a call.
v1::InteractResponse EndResponse(const absl::Status& why);
// Returns the answer to a refused request.
v1::InteractResponse RefusedResponse(std::uint64_t request_id, const absl::Status& why);

v1::Role RoleMessage(session::Role role);

void ToMessage(const session::Rules& rules, v1::SessionRules& message);
void ToMessage(const session::Mark& mark, v1::Mark& message);

}  // namespace thunderhead::service
