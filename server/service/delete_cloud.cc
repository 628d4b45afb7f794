#include "absl/strings/str_cat.h"
#include "base/guarded.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

// Reports the deletion to all people who see the cloud, in the session's view or in an own view.
// They keep the last frame.
void TellSessions(session::Sessions& sessions, const std::string& storm_id) {
  for (const std::shared_ptr<session::Session>& session : sessions.AllDrawn()) {
    const std::optional<session::NewestScene> newest = session->Newest();
    if (!newest.has_value() || newest->scene->storm_id != storm_id) continue;
    session->hub().Publish(
        {.scene_revision = newest->revision,
         .message = absl::StrCat("the cloud '", storm_id, "' was deleted; choose another storm"),
         .code = delivery::Problem::Code::kStormGone});
  }
}

absl::Status Delete(Engine& engine, const std::string& storm_id) {
  THUNDERHEAD_RETURN_IF_ERROR(engine.clouds.Delete(storm_id));
  TellSessions(engine.sessions, storm_id);
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* DeleteCloud(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::DeleteCloudRequest* request,
                                      v1::DeleteCloudResponse* response) {
  if (const absl::Status limits = CheckLimits(*request); !limits.ok()) {
    return rpc_port::Refused(context, *caller, limits);
  }
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  engine.executor.Submit(caller->identity().name, [=, &engine](const absl::Status& status) {
    const absl::Status deleted =
        status.ok() ? base::Guarded([&] { return Delete(engine, request->storm_id()); }) : status;
    caller->Report("DeleteCloud", deleted);
    answer->Give(deleted);
  });
  return answer;
}

}  // namespace thunderhead::service
