#include "service/interact/person_requests.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "service/engine/scene_update.h"
#include "service/interact/interact_messages.h"
#include "service/interact/interact_requests.h"
#include "service/messages/camera_messages.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"
#include "session/upkeep.h"

namespace thunderhead::service {
namespace {

using session::Clock;

// Returns the answer for a request that is answered only if it was refused.
std::optional<v1::InteractResponse> RefusalOf(std::uint64_t request_id,
                                              const absl::Status& status) {
  if (status.ok()) return std::nullopt;
  return RefusedResponse(request_id, status);
}

v1::InteractResponse SceneTaken(std::uint64_t request_id, std::uint64_t revision) {
  v1::InteractResponse response;
  response.mutable_scene_taken()->set_request_id(request_id);
  response.mutable_scene_taken()->set_scene_revision(revision);
  return response;
}

}  // namespace

absl::Status PersonRequests::Obey(const std::shared_ptr<Asker>& asker,
                                  const v1::InteractRequest& request) {
  switch (request.message_case()) {
    case v1::InteractRequest::kUpdateScene:
      return Update(asker, request.request_id(), request.update_scene());
    case v1::InteractRequest::kMoveCamera:
      return MoveCamera(asker, request.request_id(), request.move_camera());
    case v1::InteractRequest::kDetach:
      return Detach(asker, request.request_id(), request.detach());
    case v1::InteractRequest::kPoint:
      return Point(request.point());
    case v1::InteractRequest::kAddMark:
      return AddMark(asker, request.request_id(), request.add_mark());
    case v1::InteractRequest::kEraseMarks:
      return EraseMarks(request.erase_marks());
    case v1::InteractRequest::kSetName:
      return SetName(request.set_name().name());
    case v1::InteractRequest::kFollow:
    case v1::InteractRequest::kAskControl:
    case v1::InteractRequest::kGiveControl:
    case v1::InteractRequest::kRefuseControl:
    case v1::InteractRequest::kTakeControl:
    case v1::InteractRequest::kSetRules:
      return ChangeRoster(*asker, request);
    default:
      return base::InvalidField(
          "message", "is missing, or unknown to this version of the server; set one of its fields",
          "MESSAGE_UNKNOWN");
  }
}

std::shared_ptr<session::Session> PersonRequests::OwnView() {
  return around_.Drawn([this] { return session_->audience().Follows(person_id_); });
}

absl::Status PersonRequests::ChangeRoster(Asker& asker, const v1::InteractRequest& request) {
  const Clock::time_point now = session_->Now();
  absl::Status status = session_->audience().Change(
      [&](session::Roster& roster) {
        switch (request.message_case()) {
          case v1::InteractRequest::kFollow:
            return roster.Follow(person_id_);
          case v1::InteractRequest::kAskControl:
            return roster.AskControl(person_id_, now);
          case v1::InteractRequest::kGiveControl:
            return roster.GiveControl(person_id_, request.give_control().viewer_id(), now);
          case v1::InteractRequest::kRefuseControl:
            return roster.RefuseControl(person_id_, request.refuse_control().viewer_id());
          case v1::InteractRequest::kTakeControl:
            return roster.TakeControl(person_id_);
          default:
            return roster.SetRules(person_id_,
                                   RulesOf(request.set_rules().rules(), roster.rules()));
        }
      },
      now);
  // Wakes the call, so that a person who follows again sees the session's view at once.
  asker.Wake();
  return status;
}

absl::Status PersonRequests::SetName(const std::string& text) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string name, NameOf(text, "set_name.name"));
  return session_->audience().Change(
      [&](session::Roster& roster) {
        roster.Rename(person_id_, name);
        return absl::OkStatus();
      },
      session_->Now());
}

absl::Status PersonRequests::Update(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                                    const v1::SceneUpdate& update) {
  asker->Await();
  ChangeScene(
      engine_, caller_->identity().name, session_, SceneChangeOf(update),
      [this, asker] { return session_->audience().MaySteer(person_id_); },
      [this, asker, request_id](const absl::StatusOr<std::uint64_t>& revision) {
        caller_->ReportRefusal("Interact/update_scene", revision.status());
        asker->Settle(revision.ok() ? SceneTaken(request_id, *revision)
                                    : RefusedResponse(request_id, revision.status()));
      });
  return absl::OkStatus();
}

// Calls `take` with the camera, after filling in its defaults, or with an error. The call happens
// at once, or on the executor if the defaults depend on the storm. If this function returns an
// error, `take` is not called.
absl::Status PersonRequests::WithCamera(const std::shared_ptr<Asker>& asker,
                                        std::uint64_t request_id, const v1::Camera& message,
                                        TakeCamera take) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const ReadScene newest, NewestSceneOf(*session_));
  const auto scene = std::make_shared<v1::Scene>(newest.scene);
  if (message.kind_case() != v1::Camera::KIND_NOT_SET) *scene->mutable_camera() = message;
  THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine_.store, engine_.loop.Techniques(), *scene));
  asker->Await();
  FrameThen(engine_, caller_->identity().name, *scene,
            [asker, request_id, scene, take = std::move(take)](const absl::Status& framed) {
              using Camera = absl::StatusOr<scene::Camera>;
              const absl::Status status = base::Guarded([&] {
                return take(framed.ok() ? Camera(ToCamera(scene->camera())) : Camera(framed));
              });
              asker->Settle(RefusalOf(request_id, status));
            });
  return absl::OkStatus();
}

// Cameras of a person's own view take effect in the order of their requests, even if some wait for
// the storm's fields. A person who returns to the session's view meanwhile stays there.
absl::Status PersonRequests::Detach(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                                    const v1::Detach& detach) {
  const std::uint64_t returns = session_->audience().Returns(person_id_);
  const std::uint64_t look = around_.Begin(true);
  absl::Status asked =
      WithCamera(asker, request_id, detach.camera(),
                 [this, asker, look, returns](const absl::StatusOr<scene::Camera>& camera) {
                   absl::Status status = DetachTo(*asker, look, returns, camera);
                   around_.EndDetach();
                   return status;
                 });
  if (!asked.ok()) around_.EndDetach();
  return asked;
}

// The person leaves the session's view only when the camera of the own view is known. A person
// whose camera is refused therefore keeps following the session's view.
absl::Status PersonRequests::DetachTo(Asker& asker, std::uint64_t look, std::uint64_t returns,
                                      const absl::StatusOr<scene::Camera>& camera) {
  THUNDERHEAD_RETURN_IF_ERROR(camera.status());
  bool detached = false;
  THUNDERHEAD_RETURN_IF_ERROR(session_->audience().Change(
      [&](session::Roster& roster) -> absl::Status {
        THUNDERHEAD_ASSIGN_OR_RETURN(detached, roster.Detach(person_id_, returns));
        return absl::OkStatus();
      },
      session_->Now()));
  if (!detached) return absl::OkStatus();
  around_.LookFrom(look, *camera, [this](const scene::Camera& first) {
    return engine_.sessions.OpenView(session_, first, caller_->identity().name);
  });
  asker.Wake();
  return absl::OkStatus();
}

absl::Status PersonRequests::MoveCamera(const std::shared_ptr<Asker>& asker,
                                        std::uint64_t request_id, const v1::MoveCamera& move) {
  if (!around_.Looks()) {
    return base::WithDetails(
        absl::FailedPreconditionError("you follow the session's view; detach from it first"),
        {.reason = "NOT_DETACHED"});
  }
  const std::uint64_t look = around_.Begin(false);
  return WithCamera(asker, request_id, move.camera(),
                    [this, look](const absl::StatusOr<scene::Camera>& camera) {
                      if (camera.ok()) around_.LookFrom(look, *camera, nullptr);
                      return camera.status();
                    });
}

absl::Status PersonRequests::Point(const v1::Point& point) {
  std::optional<session::Ray> ray;
  if (point.has_ray()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(ray, RayOf(point.ray(), "point.ray"));
  }
  return session_->audience().Point(person_id_, ray, session_->Now());
}

// Computes the mark's positions on the executor, because it may have many.
absl::Status PersonRequests::AddMark(const std::shared_ptr<Asker>& asker, std::uint64_t request_id,
                                     const v1::AddMark& message) {
  THUNDERHEAD_RETURN_IF_ERROR(session_->audience().MayMark(person_id_));
  if (drawing_.exchange(true)) {
    return base::WithDetails(
        absl::ResourceExhaustedError("your last mark is still being placed; wait for it"),
        {.reason = "MARKS_TOO_FAST", .retry_after = std::chrono::milliseconds(200)});
  }
  absl::Status status = PlaceMark(asker, request_id, message);
  if (!status.ok()) drawing_ = false;
  return status;
}

absl::Status PersonRequests::PlaceMark(const std::shared_ptr<Asker>& asker,
                                       std::uint64_t request_id, const v1::AddMark& message) {
  std::vector<session::Ray> rays;
  for (const v1::Ray& one : message.rays()) {
    const std::string path = absl::StrCat("add_mark.rays[", rays.size(), "]");
    THUNDERHEAD_ASSIGN_OR_RETURN(rays.emplace_back(), RayOf(one, path));
  }
  if (rays.empty()) {
    return base::InvalidField("add_mark.rays", "is empty; a mark has at least one corner",
                              "VALUE_MISSING");
  }
  std::optional<glm::vec3> color;
  if (message.has_color()) {
    color = glm::vec3(message.color().red(), message.color().green(), message.color().blue());
  }
  asker->Await();
  engine_.executor.Submit(
      caller_->identity().name,
      [this, asker, request_id, rays = std::move(rays), color](const absl::Status& status) {
        using Positions = absl::StatusOr<std::vector<glm::dvec3>>;
        Positions positions_m = base::Guarded([&]() -> Positions {
          THUNDERHEAD_RETURN_IF_ERROR(status);
          return session::LineSeen(*session_, engine_.store, rays);
        });
        // The flag is reset before the mark is announced, because the person may draw the next mark
        // as soon as the announcement arrives.
        drawing_ = false;
        const absl::Status drawn =
            positions_m.ok() ? Draw(*std::move(positions_m), color) : positions_m.status();
        asker->Settle(RefusalOf(request_id, drawn));
      });
  return absl::OkStatus();
}

absl::Status PersonRequests::Draw(std::vector<glm::dvec3> positions_m,
                                  const std::optional<glm::vec3>& color) {
  return base::Guarded([&] {
    return session_->audience().Draw(
        person_id_,
        [&](session::Board& board) {
          return board.Add(person_id_, std::move(positions_m), color, participant_key_).status();
        },
        session_->Now());
  });
}

absl::Status PersonRequests::EraseMarks(const v1::EraseMarks& message) {
  return session_->audience().Erase(
      person_id_, {message.mark_ids().begin(), message.mark_ids().end()}, session_->Now());
}

}  // namespace thunderhead::service
