// The methods of Session that handle the messages from the server.
#include <utility>

#include "google/rpc/status.pb.h"
#include "thunderhead_client/session.h"
#include "thunderhead_client/session_call.h"

namespace thunderhead::client {
namespace {

SceneSync::Refusal RefusalOf(int code) {
  if (code == grpc::StatusCode::ABORTED) return SceneSync::Refusal::kStale;
  if (code == grpc::StatusCode::RESOURCE_EXHAUSTED || code == grpc::StatusCode::UNAVAILABLE) {
    return SceneSync::Refusal::kBusy;
  }
  return SceneSync::Refusal::kRefused;
}

}  // namespace

void Session::Take(Call& call, v1::InteractResponse& response) {
  if (response.has_frame()) {
    {
      const std::lock_guard lock(mutex_);
      call.heard_at = Clock::now();
    }
    const std::size_t bytes = response.ByteSizeLong();
    listener_.Received(std::move(*response.mutable_frame()), bytes);
    return;
  }
  const bool began = response.has_joined();
  {
    std::unique_lock lock(mutex_);
    call.heard_at = Clock::now();
    switch (response.message_case()) {
      case v1::InteractResponse::kJoined:
        Joined(call, response.joined());
        break;
      case v1::InteractResponse::kProblem:
        state_.problem = response.problem();
        break;
      case v1::InteractResponse::kScene:
        sync_.Told(response.scene().scene(), response.scene().scene_revision());
        break;
      case v1::InteractResponse::kSceneTaken:
        TakeScene(call, response.scene_taken(), lock);
        break;
      case v1::InteractResponse::kRefused:
        TakeRefusal(call, response.refused());
        break;
      case v1::InteractResponse::kPresence:
        TakePresence(response.presence());
        break;
      case v1::InteractResponse::kPointers:
        state_.pointers = response.pointers();
        break;
      case v1::InteractResponse::kMarks:
        state_.Take(response.marks());
        break;
      case v1::InteractResponse::kTimesInMemory:
        state_.times_in_memory = response.times_in_memory();
        break;
      case v1::InteractResponse::kCatalogueChanged:
        state_.catalogue_revision = response.catalogue_changed().revision();
        break;
      case v1::InteractResponse::kCheckAlive: {
        v1::InteractRequest alive;
        alive.mutable_alive();
        outbox_.Send(std::move(alive));
        break;
      }
      case v1::InteractResponse::kEnd: {
        const v1::End& end = response.end();
        call.farewell = Outcome{end.has_retry_after_ms() ? Link::kLost : Link::kGone, end.message(),
                                std::chrono::milliseconds(end.retry_after_ms())};
        break;
      }
      default:
        break;
    }
    // The responses to scenes that were sent before another viewer took control arrive later, so
    // edits may be discarded after any message.
    if (sync_.TakeDiscarded()) Say("Your last change was not made: another person is in control");
    Touch();
  }
  if (began) listener_.StreamBegan();
  changed_.notify_all();
  listener_.Changed();
}

void Session::Joined(Call& call, const v1::Joined& joined) {
  call.joined = true;
  call.joined_at = Clock::now();
  state_.link = Link::kLive;
  state_.reason.clear();
  ++state_.joined_count;
  if (!opened_) resumption_.Rejoined(state_.viewer_id, state_.presence);
  state_.viewer_id = joined.viewer_id();
  state_.role = joined.role();
  state_.viewer_key = joined.viewer_key();
  if (joined.role() == v1::ROLE_PRESENTER) state_.presenter_key = key_;
  participant_key_ = joined.participant_key();
  state_.presence.Clear();
  state_.problem.reset();
  sync_.Rejoined();
  if (!state_.looks_around) return;
  v1::InteractRequest request;
  *request.mutable_detach()->mutable_camera() = state_.own_camera;
  outbox_.Send(std::move(request));
}

void Session::TakeScene(Call& call, const v1::SceneTaken& taken,
                        std::unique_lock<std::mutex>& lock) {
  const auto sent = call.scenes.find(taken.request_id());
  if (sent == call.scenes.end()) return;
  sync_.Taken(sent->second.ticket, taken.scene_revision());
  const Clock::time_point at = sent->second.at;
  call.scenes.erase(sent);
  lock.unlock();
  listener_.SceneTaken(taken.scene_revision(), at);
  lock.lock();
}

void Session::TakePresence(const v1::Presence& presence) {
  const bool steered = state_.Steers();
  state_.presence = presence;
  if (state_.Steers()) {
    resumption_.End();
    sync_.Keep();
    if (state_.looks_around) {
      state_.looks_around = false;
      outbox_.DropCamera();
      v1::InteractRequest request;
      request.mutable_follow();
      outbox_.Send(std::move(request));
    }
    if (!steered && !opened_ && !state_.Alone()) Say("You steer");
  } else {
    const auto resumption = resumption_.Of(presence, state_.Presents());
    const bool opens = opened_ && presence.steering_viewer_id() == 0;
    if (opens || resumption == ControlResumption::Outcome::kTakes) {
      v1::InteractRequest request;
      request.mutable_take_control();
      outbox_.Send(std::move(request));
    } else if (resumption == ControlResumption::Outcome::kLost) {
      sync_.Discard();
    }
    if (state_.looks_around && !state_.MayLookAround()) state_.looks_around = false;
  }
  opened_ = false;
}

void Session::TakeRefusal(Call& call, const v1::Refused& refused) {
  const std::uint64_t id = refused.request_id();
  if (const auto scene = call.scenes.find(id); scene != call.scenes.end()) {
    const SceneSync::Refusal refusal = RefusalOf(refused.status().code());
    sync_.Refused(scene->second.ticket, refusal, Clock::now());
    call.scenes.erase(scene);
    if (refusal != SceneSync::Refusal::kStale) Say(refused.status().message());
    return;
  }
  const auto found = call.requests.find(id);
  if (found == call.requests.end()) return;
  switch (found->second) {
    case v1::InteractRequest::kPoint:  // a pointer or acknowledgement came too late or too often;
                                       // no reaction is needed
    case v1::InteractRequest::kAcknowledge:
      return;
    case v1::InteractRequest::kMoveCamera:
      // The refusal means that the server has ended the client's own view.
      if (refused.status().code() == grpc::StatusCode::FAILED_PRECONDITION) {
        state_.looks_around = false;
      }
      return;
    case v1::InteractRequest::kDetach:
      state_.looks_around = false;
      break;
    default:
      break;
  }
  Say(refused.status().message());
}

void Session::Say(const std::string& notice) {
  state_.notice = notice;
  ++state_.notice_count;
}

}  // namespace thunderhead::client
