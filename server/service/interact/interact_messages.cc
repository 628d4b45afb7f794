#include "service/interact/interact_messages.h"

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "base/error_details.h"
#include "rpc_port/status_table.h"
#include "rpc_port/wire.h"
#include "service/engine/frame_messages.h"
#include "service/messages/camera_messages.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

// The delay after which clients should reconnect if the status states none. They add a random
// delay, so that they do not all reconnect at once.
constexpr std::chrono::milliseconds kComeBackAfter{1000};

void SetPerson(const session::Person& person, v1::Person& message) {
  message.set_viewer_id(person.id);
  message.set_name(person.name);
  message.set_role(RoleMessage(person.role));
  message.set_follows(person.follows);
  message.set_hidden(person.hidden);
  message.set_asks_control(person.asks);
}

std::string PresenceOf(const session::Roster& roster) {
  v1::InteractResponse response;
  v1::Presence& presence = *response.mutable_presence();
  for (const session::Person& person : roster.people()) SetPerson(person, *presence.add_people());
  presence.set_steering_viewer_id(roster.steering());
  presence.set_presenter_away(roster.presenter_away());
  if (const session::Person* const awaited = roster.awaited(); awaited != nullptr) {
    SetPerson(*awaited, *presence.mutable_awaited());
  }
  ToMessage(roster.rules(), *presence.mutable_rules());
  return response.SerializeAsString();
}

std::string PointersOf(const std::vector<session::Pointer>& pointers) {
  v1::InteractResponse response;
  v1::Pointers& message = *response.mutable_pointers();
  for (const session::Pointer& pointer : pointers) {
    v1::Pointer& one = *message.add_pointers();
    one.set_viewer_id(pointer.person_id);
    SetPosition(pointer.position_m, *one.mutable_position());
  }
  return response.SerializeAsString();
}

std::string MarksOf(const std::vector<session::Mark>& marks) {
  v1::InteractResponse response;
  v1::Marks& message = *response.mutable_marks();
  for (const session::Mark& mark : marks) ToMessage(mark, *message.add_marks());
  return response.SerializeAsString();
}

std::string MarksChangeOf(const session::MarksChange& change) {
  v1::InteractResponse response;
  v1::Marks& message = *response.mutable_marks();
  message.set_only_changes(true);
  for (const session::Mark& mark : change.drawn) ToMessage(mark, *message.add_marks());
  message.mutable_erased_mark_ids()->Add(change.erased.begin(), change.erased.end());
  return response.SerializeAsString();
}

std::string TimesInMemoryOf(const session::HeldTimes& held) {
  v1::InteractResponse response;
  v1::TimesInMemory& message = *response.mutable_times_in_memory();
  message.set_storm_id(held.storm_id);
  for (const int index : held.time_indices) {
    message.add_time_indices(static_cast<std::uint32_t>(index));
  }
  return response.SerializeAsString();
}

v1::End::Reason EndReason(const absl::Status& why) {
  const std::string reason = base::DetailsOf(why).reason;
  if (reason == "SESSION_EXPIRED") return v1::End::REASON_EXPIRED;
  if (absl::IsUnavailable(why)) return v1::End::REASON_SERVER_STOPS;
  return v1::End::REASON_CLOSED;
}

}  // namespace

session::AudienceFormat InteractFormat() {
  return {PresenceOf, PointersOf, MarksOf, MarksChangeOf, TimesInMemoryOf};
}

std::string SerializedFrame(const delivery::EncodedFrame& frame) {
  v1::Frame message;
  ToMessage(frame, message);
  return message.SerializeAsString();
}

grpc::ByteBuffer FrameResponse(const std::shared_ptr<const delivery::EncodedFrame>& frame,
                               bool own_view) {
  std::string fields;
  rpc_port::AppendNumber(v1::Frame::kSequenceFieldNumber, frame->sequence, &fields);
  if (own_view) rpc_port::AppendNumber(v1::Frame::kOwnViewFieldNumber, 1, &fields);
  std::string prefix;
  rpc_port::AppendLength(v1::InteractResponse::kFrameFieldNumber,
                         fields.size() + frame->serialized.size(), &prefix);
  prefix += fields;
  return rpc_port::Joined(prefix, rpc_port::SharedSlice({frame, &frame->serialized}));
}

grpc::ByteBuffer SceneResponse(const session::NewestScene& scene) {
  std::string fields;
  rpc_port::AppendNumber(v1::SceneState::kSceneRevisionFieldNumber, scene.revision, &fields);
  rpc_port::AppendLength(v1::SceneState::kSceneFieldNumber, scene.serialized->size(), &fields);
  std::string prefix;
  rpc_port::AppendLength(v1::InteractResponse::kSceneFieldNumber,
                         fields.size() + scene.serialized->size(), &prefix);
  prefix += fields;
  return rpc_port::Joined(prefix, rpc_port::SharedSlice(scene.serialized));
}

grpc::ByteBuffer ResponseOf(const v1::InteractResponse& response) {
  return rpc_port::Whole(response.SerializeAsString());
}

v1::InteractResponse EndResponse(const absl::Status& why) {
  v1::InteractResponse response;
  v1::End& end = *response.mutable_end();
  end.set_reason(EndReason(why));
  end.set_message(rpc_port::SendableMessage(why));
  if (end.reason() == v1::End::REASON_SERVER_STOPS) {
    const auto after = base::DetailsOf(why).retry_after.value_or(kComeBackAfter);
    end.set_retry_after_ms(static_cast<std::uint32_t>(after.count()));
  }
  return response;
}

v1::InteractResponse RefusedResponse(std::uint64_t request_id, const absl::Status& why) {
  v1::InteractResponse response;
  v1::Refused& refused = *response.mutable_refused();
  refused.set_request_id(request_id);
  const grpc::Status status = rpc_port::ToGrpcStatus(why);
  if (!refused.mutable_status()->ParseFromString(status.error_details()) ||
      refused.status().code() == 0) {
    refused.mutable_status()->set_code(status.error_code());
    refused.mutable_status()->set_message(status.error_message());
  }
  return response;
}

v1::Role RoleMessage(session::Role role) {
  return role == session::Role::kPresenter ? v1::ROLE_PRESENTER : v1::ROLE_VIEWER;
}

void ToMessage(const session::Rules& rules, v1::SessionRules& message) {
  message.set_viewers_may_steer(rules.viewers_may_steer);
  message.set_control_locked(rules.control_locked);
  message.set_following_locked(rules.following_locked);
  message.set_viewers_may_mark(rules.viewers_may_mark);
  message.set_free_when_away(rules.free_when_away);
}

void ToMessage(const session::Mark& mark, v1::Mark& message) {
  message.set_mark_id(mark.id);
  message.set_viewer_id(mark.person_id);
  for (const glm::dvec3& position_m : mark.positions_m) {
    SetPosition(position_m, *message.add_positions());
  }
  message.mutable_color()->set_red(mark.color.r);
  message.mutable_color()->set_green(mark.color.g);
  message.mutable_color()->set_blue(mark.color.b);
}

}  // namespace thunderhead::service
