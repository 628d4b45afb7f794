#include "service/thunderhead_service.h"

#include "service/handlers.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* ThunderheadService::GetServerInfo(grpc::CallbackServerContext* context,
                                                            const v1::GetServerInfoRequest* request,
                                                            v1::GetServerInfoResponse* response) {
  return service::GetServerInfo(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::ListStorms(grpc::CallbackServerContext* context,
                                                         const v1::ListStormsRequest* request,
                                                         v1::ListStormsResponse* response) {
  return service::ListStorms(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::DescribeStorm(grpc::CallbackServerContext* context,
                                                            const v1::DescribeStormRequest* request,
                                                            v1::DescribeStormResponse* response) {
  return service::DescribeStorm(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::GenerateCloud(grpc::CallbackServerContext* context,
                                                            const v1::GenerateCloudRequest* request,
                                                            v1::GenerateCloudResponse* response) {
  return service::GenerateCloud(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::DeleteCloud(grpc::CallbackServerContext* context,
                                                          const v1::DeleteCloudRequest* request,
                                                          v1::DeleteCloudResponse* response) {
  return service::DeleteCloud(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::CreateSession(grpc::CallbackServerContext* context,
                                                            const v1::CreateSessionRequest* request,
                                                            v1::CreateSessionResponse* response) {
  return service::CreateSession(engine_, context, request, response);
}

InteractReactor* ThunderheadService::Interact(grpc::CallbackServerContext* /*context*/) {
  return service::Interact(engine_);
}

grpc::ServerUnaryReactor* ThunderheadService::UpdateScene(grpc::CallbackServerContext* context,
                                                          const v1::UpdateSceneRequest* request,
                                                          v1::UpdateSceneResponse* response) {
  return service::UpdateScene(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::AcknowledgeFrame(
    grpc::CallbackServerContext* context, const v1::AcknowledgeFrameRequest* request,
    v1::AcknowledgeFrameResponse* response) {
  return service::AcknowledgeFrame(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::CloseSession(grpc::CallbackServerContext* context,
                                                           const v1::CloseSessionRequest* request,
                                                           v1::CloseSessionResponse* response) {
  return service::CloseSession(engine_, context, request, response);
}

grpc::ServerUnaryReactor* ThunderheadService::RenderImage(grpc::CallbackServerContext* context,
                                                          const v1::RenderImageRequest* request,
                                                          v1::RenderImageResponse* response) {
  return service::RenderImage(engine_, context, request, response);
}

grpc::ServerWriteReactor<v1::RenderImageEvent>* ThunderheadService::RenderImageWithProgress(
    grpc::CallbackServerContext* context, const v1::RenderImageRequest* request) {
  return service::RenderImageWithProgress(engine_, context, request);
}

grpc::ServerWriteReactor<v1::WatchFramesResponse>* ThunderheadService::WatchFrames(
    grpc::CallbackServerContext* context, const v1::WatchFramesRequest* request) {
  return service::WatchFrames(engine_, context, request);
}

}  // namespace thunderhead::service
