#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/engine/scene_update.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

absl::StatusOr<std::shared_ptr<session::Session>> FindToSteer(
    Engine& engine, const v1::UpdateSceneRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(const session::FoundSession found,
                               engine.sessions.Find(request.session_id()));
  if (found.role != session::Role::kPresenter) {
    return base::WithDetails(
        absl::PermissionDeniedError("this call needs the presenter's key; viewers change the scene "
                                    "with Interact, after asking for control"),
        {.reason = "NOT_PRESENTER"});
  }
  return found.session;
}

}  // namespace

grpc::ServerUnaryReactor* UpdateScene(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::UpdateSceneRequest* request,
                                      v1::UpdateSceneResponse* response) {
  const auto session = FindToSteer(engine, *request);
  if (!session.ok()) return rpc_port::Refused(context, *caller, session.status());
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  ChangeScene(
      engine, caller->identity().name, *session, SceneChangeOf(*request),
      [session = *session] { return session->audience().PresenterMaySteer(); },
      [=](const absl::StatusOr<std::uint64_t>& revision) {
        if (revision.ok()) response->set_scene_revision(*revision);
        caller->ReportRefusal(revision.status());
        answer->Give(revision.status());
      });
  return answer;
}

}  // namespace thunderhead::service
