// The responses of Interact, as bytes that all people share. Its requests are in
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

// Whole responses as bytes, for session::Audience.
session::AudienceFormat InteractFormat();
// A frame's message without its sequence, for session::FrameEncoder.
std::string SerializedFrame(const delivery::EncodedFrame& frame);

// Responses. Those of frames and scenes share the bytes of their largest part.
grpc::ByteBuffer FrameResponse(const std::shared_ptr<const delivery::EncodedFrame>& frame,
                               bool own_view);
grpc::ByteBuffer SceneResponse(const session::NewestScene& scene);
grpc::ByteBuffer ResponseOf(const v1::InteractResponse& response);
// The call's last message.
v1::InteractResponse EndResponse(const absl::Status& why);
// The answer to a request that was not obeyed.
v1::InteractResponse RefusedResponse(std::uint64_t request_id, const absl::Status& why);

v1::Role RoleMessage(session::Role role);

void ToMessage(const session::Rules& rules, v1::SessionRules& message);
void ToMessage(const session::Mark& mark, v1::Mark& message);

}  // namespace thunderhead::service
