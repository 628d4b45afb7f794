#include "service/thunderhead_service.h"

#include <utility>

#include "service/admission.h"
#include "service/finished.h"
#include "service/handlers.h"

namespace thunderhead::service {

using access::CallKind;

grpc::ServerUnaryReactor* ThunderheadService::GetServerInfo(grpc::CallbackServerContext* context,
                                                            const v1::GetServerInfoRequest* request,
                                                            v1::GetServerInfoResponse* response) {
  const CallerOr caller = Admit(door_, *context, "GetServerInfo", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::GetServerInfo(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::ListStorms(grpc::CallbackServerContext* context,
                                                         const v1::ListStormsRequest* request,
                                                         v1::ListStormsResponse* response) {
  const CallerOr caller = Admit(door_, *context, "ListStorms", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::ListStorms(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::DescribeStorm(grpc::CallbackServerContext* context,
                                                            const v1::DescribeStormRequest* request,
                                                            v1::DescribeStormResponse* response) {
  const CallerOr caller = Admit(door_, *context, "DescribeStorm", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::DescribeStorm(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::GetStormMap(grpc::CallbackServerContext* context,
                                                          const v1::GetStormMapRequest* request,
                                                          v1::GetStormMapResponse* response) {
  const CallerOr caller = Admit(door_, *context, "GetStormMap", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::GetStormMap(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::ProbeRay(grpc::CallbackServerContext* context,
                                                       const v1::ProbeRayRequest* request,
                                                       v1::ProbeRayResponse* response) {
  const CallerOr caller = Admit(door_, *context, "ProbeRay", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::ProbeRay(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::GenerateCloud(grpc::CallbackServerContext* context,
                                                            const v1::GenerateCloudRequest* request,
                                                            v1::GenerateCloudResponse* response) {
  const CallerOr caller = Admit(door_, *context, "GenerateCloud", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::GenerateCloud(engine_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::DeleteCloud(grpc::CallbackServerContext* context,
                                                          const v1::DeleteCloudRequest* request,
                                                          v1::DeleteCloudResponse* response) {
  const CallerOr caller = Admit(door_, *context, "DeleteCloud", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::DeleteCloud(engine_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::CreateSession(grpc::CallbackServerContext* context,
                                                            const v1::CreateSessionRequest* request,
                                                            v1::CreateSessionResponse* response) {
  const CallerOr caller = Admit(door_, *context, "CreateSession", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::CreateSession(engine_, context, *caller, request, response);
}

InteractReactor* ThunderheadService::Interact(grpc::CallbackServerContext* context) {
  CallerOr caller = Admit(door_, *context, "Interact", CallKind::kStream);
  if (!caller.ok()) return new RefusedStream<InteractReactor>(caller.status());
  return service::Interact(engine_, *std::move(caller), door_.limits().requests_per_second);
}

grpc::ServerUnaryReactor* ThunderheadService::UpdateScene(grpc::CallbackServerContext* context,
                                                          const v1::UpdateSceneRequest* request,
                                                          v1::UpdateSceneResponse* response) {
  const CallerOr caller = Admit(door_, *context, "UpdateScene", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::UpdateScene(engine_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::AcknowledgeFrame(
    grpc::CallbackServerContext* context, const v1::AcknowledgeFrameRequest* request,
    v1::AcknowledgeFrameResponse* response) {
  const CallerOr caller = Admit(door_, *context, "AcknowledgeFrame", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::AcknowledgeFrame(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::CloseSession(grpc::CallbackServerContext* context,
                                                           const v1::CloseSessionRequest* request,
                                                           v1::CloseSessionResponse* response) {
  const CallerOr caller = Admit(door_, *context, "CloseSession", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::CloseSession(engine_, context, *caller, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::RenderImage(grpc::CallbackServerContext* context,
                                                          const v1::RenderImageRequest* request,
                                                          v1::RenderImageResponse* response) {
  const CallerOr caller = Admit(door_, *context, "RenderImage", CallKind::kUnary);
  if (!caller.ok()) return Finished(context, caller.status());
  return service::RenderImage(engine_, context, *caller, request, response);
}

grpc::ServerWriteReactor<v1::RenderImageEvent>* ThunderheadService::RenderImageWithProgress(
    grpc::CallbackServerContext* context, const v1::RenderImageRequest* request) {
  CallerOr caller = Admit(door_, *context, "RenderImageWithProgress", CallKind::kStream);
  if (!caller.ok()) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::RenderImageEvent>>(caller.status());
  }
  return service::RenderImageWithProgress(engine_, context, *std::move(caller), request);
}

grpc::ServerWriteReactor<v1::WatchFramesResponse>* ThunderheadService::WatchFrames(
    grpc::CallbackServerContext* context, const v1::WatchFramesRequest* request) {
  CallerOr caller = Admit(door_, *context, "WatchFrames", CallKind::kStream);
  if (!caller.ok()) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::WatchFramesResponse>>(caller.status());
  }
  return service::WatchFrames(engine_, context, *std::move(caller), request);
}

}  // namespace thunderhead::service
