#include <memory>

#include "service/finished.h"
#include "service/handlers.h"
#include "service/limits_check.h"
#include "service/scene_messages.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* UpdateScene(Engine& engine, grpc::CallbackServerContext* context,
                                      const v1::UpdateSceneRequest* request,
                                      v1::UpdateSceneResponse* response) {
  if (const absl::Status status = CheckLimits(*request); !status.ok()) {
    return Finished(context, status);
  }
  const auto session = engine.sessions.Find(request->session_id());
  if (!session.ok()) return Finished(context, session.status());
  const auto scene = std::make_shared<v1::Scene>(request->scene());
  if (const absl::Status status = PrepareScene(engine.store, engine.loop.Techniques(), *scene);
      !status.ok()) {
    return Finished(context, status);
  }
  // Taken before the scene is framed, which may wait for a read, so that the last update wins.
  const std::uint64_t revision = (*session)->TakeRevision();
  response->set_scene_revision(revision);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  FrameThen(engine, *scene, [=, session = *session](const absl::Status& framed) {
    if (framed.ok()) session->Show(revision, ToScene(*scene), scene->SerializeAsString());
    reactor->Finish(ToGrpcStatus(framed));
  });
  return reactor;
}

}  // namespace thunderhead::service
