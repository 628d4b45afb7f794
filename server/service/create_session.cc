#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/timed_calls.h"
#include "rpc_port/finished.h"
#include "service/engine/scene_update.h"
#include "service/handlers.h"
#include "service/interact/interact_requests.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "telemetry/metrics.h"

namespace thunderhead::service {
namespace {

absl::Status Open(Engine& engine, const std::string& owner, const session::Rules& rules,
                  v1::CreateSessionResponse& response) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto session, engine.sessions.Create(rules, owner));
  const std::uint64_t revision = session->TakeRevision();
  ShowScene(engine.store, *session, revision, response.scene());
  response.set_session_id(session->keys().presenter);
  response.set_viewer_key(session->keys().viewer);
  response.set_scene_revision(revision);
  return absl::OkStatus();
}

// Handles the result of saving the session. If the storage hangs, the session is refused, because
// the response could not say whether it is saved. After any other error, such as a full disk, the
// session is opened nevertheless, so that for example a lesson can begin. The response then says
// that the session is not saved (`durable`).
absl::Status Saved(Engine& engine, const absl::Status& saved, v1::CreateSessionResponse& response) {
  if (base::DetailsOf(saved).reason == base::kStorageHangs) {
    // The session can be closed because its keys were not sent to any client.
    (void)engine.sessions.Close(response.session_id());
    return base::Annotate(saved, "no session can be opened, because it cannot be saved");
  }
  if (engine.keeper != nullptr) response.set_durable(saved.ok());
  telemetry::Counted().sessions_opened.Add();
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* CreateSession(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::CreateSessionRequest* request,
                                        v1::CreateSessionResponse* response) {
  absl::Status status = CheckLimits(*request);
  v1::Scene& scene = *response->mutable_scene();
  scene = request->scene();
  if (status.ok()) status = PrepareScene(engine.store, engine.loop.Techniques(), scene);
  if (status.ok()) status = CheckSize(engine.limits, scene);
  if (!status.ok()) return rpc_port::Refused(context, *caller, status);
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  const session::Rules rules = RulesOf(request->rules(), {});
  FrameThen(engine, caller->identity().name, scene, [=, &engine](const absl::Status& framed) {
    const absl::Status opened =
        framed.ok()
            ? base::Guarded([&] { return Open(engine, caller->identity().name, rules, *response); })
            : framed;
    const auto finish = [caller, answer](const absl::Status& outcome) {
      caller->Report("CreateSession", outcome);
      answer->Give(outcome);
    };
    if (!opened.ok()) return finish(opened);
    SaveThen(engine, [=, &engine](const session::SessionKeeper::Outcome& outcome) {
      finish(Saved(engine, outcome.saved, *response));
    });
  });
  return answer;
}

}  // namespace thunderhead::service
