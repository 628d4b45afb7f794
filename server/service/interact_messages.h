// Converts between Interact's messages and values: what people are told, as bytes that all of them
// share.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "session/audience.h"
#include "session/sessions.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Whole responses as bytes, for session::Audience.
session::AudienceFormat InteractFormat();
// A frame's message without its sequence, for session::FrameEncoder.
std::string SerializedFrame(const session::EncodedFrame& frame);

// Responses. Those of frames and scenes share the bytes of their largest part.
grpc::ByteBuffer FrameResponse(const std::shared_ptr<const session::EncodedFrame>& frame,
                               bool own_view);
grpc::ByteBuffer SceneResponse(const session::NewestScene& scene);
grpc::ByteBuffer ResponseOf(const v1::InteractResponse& response);
// The call's last message.
v1::InteractResponse EndResponse(const absl::Status& why);
// The answer to a request that was not obeyed.
v1::InteractResponse RefusedResponse(std::uint64_t request_id, const absl::Status& why);

v1::Role RoleMessage(session::Role role);

// `rules` with those of the message that are set.
session::Rules RulesOf(const v1::SessionRules& message, session::Rules rules);
void ToMessage(const session::Rules& rules, v1::SessionRules& message);
void ToMessage(const session::Mark& mark, v1::Mark& message);

// INVALID_ARGUMENT for a direction of length 0; `path` names the ray's field.
absl::StatusOr<session::Ray> RayOf(const v1::Ray& message, const std::string& path);

// The key that a person comes back with, or a new one if it is empty. INVALID_ARGUMENT, naming the
// field `path`, for what no server has given.
absl::StatusOr<std::string> ParticipantKeyOf(const std::string& key, const std::string& path);

// The name as others see it: without control characters, white space at its ends and what is beyond
// 40 characters. INVALID_ARGUMENT, naming the field `path`, if it is not UTF-8.
absl::StatusOr<std::string> NameOf(const std::string& name, const std::string& path);

}  // namespace thunderhead::service
