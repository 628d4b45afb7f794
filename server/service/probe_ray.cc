#include <memory>
#include <utility>

#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/engine/scene_update.h"
#include "service/handlers.h"
#include "service/interact/interact_requests.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/probe_messages.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

// A request with its defaults filled in, and the scene that it refers to.
struct Asked {
  v1::ProbeRayRequest request;
  ReadScene scene;  // its revision is 0 if the request names no session
  storm_store::StormInfoPtr storm;
};

absl::StatusOr<ReadScene> SceneOf(Engine& engine, const v1::ProbeRayRequest& request) {
  if (request.subject_case() != v1::ProbeRayRequest::kSessionId) {
    return ReadScene{0, request.scene()};
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const session::FoundSession found,
                               engine.sessions.Find(request.session_id()));
  return NewestSceneOf(*found.session);
}

absl::StatusOr<std::shared_ptr<Asked>> Check(Engine& engine, const v1::ProbeRayRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  if (request.has_ray()) THUNDERHEAD_RETURN_IF_ERROR(RayOf(request.ray(), "ray").status());
  auto asked = std::make_shared<Asked>();
  asked->request = request;
  FillDefaults(asked->request);
  THUNDERHEAD_ASSIGN_OR_RETURN(asked->scene, SceneOf(engine, request));
  v1::Scene& scene = asked->scene.scene;
  if (request.has_camera()) *scene.mutable_camera() = request.camera();
  THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine.store, engine.loop.Techniques(), scene));
  THUNDERHEAD_ASSIGN_OR_RETURN(asked->storm, FindStorm(engine.store, scene.storm_id()));
  return asked;
}

absl::StatusOr<scene::ViewRay> RayIn(const scene::Scene& scene,
                                     const volume::HydrometeorFields& fields,
                                     const v1::ProbeRayRequest& request) {
  if (!request.has_ray()) {
    return scene::RayThrough(scene::ViewOf(scene, fields), request.point().x(),
                             request.point().y());
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const session::Ray ray, RayOf(request.ray(), "ray"));
  return scene::ViewRay{ray.origin_m, ray.direction};
}

absl::Status Probe(Engine& engine, Asked& asked, v1::ProbeRayResponse& response) {
  v1::Scene& message = asked.scene.scene;
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const auto fields, ReadFields(engine.store, message.storm_id(),
                                    static_cast<int>(message.time_index()), "scene.storm_id"));
  if (NeedsFraming(message)) FrameCondensate(message, *fields);
  const scene::Scene scene = ToScene(message);
  THUNDERHEAD_ASSIGN_OR_RETURN(const scene::ViewRay ray, RayIn(scene, *fields, asked.request));
  const scene::StormRay storm_ray(scene, *fields, ray.origin_m, ray.direction);
  const double first_cloud_depth = asked.request.first_cloud_depth();
  const scene::RayProbe probe = scene::ProbeRay(
      scene, *fields, storm_ray, {static_cast<int>(asked.request.samples()), first_cloud_depth});
  response.set_storm_id(message.storm_id());
  response.set_time_index(message.time_index());
  response.set_scene_revision(asked.scene.revision);
  response.set_first_cloud_depth(asked.request.first_cloud_depth());
  const StormPlaces places(*asked.storm, static_cast<int>(message.time_index()), *fields);
  ToMessage(ray, storm_ray, probe, places, response);
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* ProbeRay(Engine& engine, grpc::CallbackServerContext* context,
                                   const CallerRef& caller, const v1::ProbeRayRequest* request,
                                   v1::ProbeRayResponse* response) {
  const auto asked = Check(engine, *request);
  if (!asked.ok()) return rpc_port::Refused(context, *caller, asked.status());
  return rpc_port::FinishedBy(engine.executor, engine.limits, context, caller, *response,
                              [=, &engine] { return Probe(engine, **asked, *response); });
}

}  // namespace thunderhead::service
