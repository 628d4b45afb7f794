// Declares one handler for each rpc of ThunderheadService except Interact (interact/interact.h).
// Each is defined in the file that is named after the rpc; RenderImageWithProgress is in
// render_image.cc. A handler uses the caller to report refusals, and to queue work in the caller's
// name.
#pragma once

#include <grpcpp/support/server_callback.h>

#include "service/engine/engine.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* GetServerInfo(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::GetServerInfoRequest* request,
                                        v1::GetServerInfoResponse* response);
grpc::ServerUnaryReactor* ListStorms(Engine& engine, grpc::CallbackServerContext* context,
                                     const CallerRef& caller, const v1::ListStormsRequest* request,
                                     v1::ListStormsResponse* response);
grpc::ServerUnaryReactor* DescribeStorm(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::DescribeStormRequest* request,
                                        v1::DescribeStormResponse* response);
grpc::ServerUnaryReactor* GetStormMap(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::GetStormMapRequest* request,
                                      v1::GetStormMapResponse* response);
grpc::ServerUnaryReactor* ProbeRay(Engine& engine, grpc::CallbackServerContext* context,
                                   const CallerRef& caller, const v1::ProbeRayRequest* request,
                                   v1::ProbeRayResponse* response);
grpc::ServerUnaryReactor* GenerateCloud(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::GenerateCloudRequest* request,
                                        v1::GenerateCloudResponse* response);
grpc::ServerUnaryReactor* DeleteCloud(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::DeleteCloudRequest* request,
                                      v1::DeleteCloudResponse* response);
grpc::ServerUnaryReactor* CreateSession(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::CreateSessionRequest* request,
                                        v1::CreateSessionResponse* response);
grpc::ServerUnaryReactor* UpdateScene(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::UpdateSceneRequest* request,
                                      v1::UpdateSceneResponse* response);
grpc::ServerWriteReactor<v1::WatchFramesResponse>* WatchFrames(
    Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
    const v1::WatchFramesRequest* request);
grpc::ServerUnaryReactor* AcknowledgeFrame(Engine& engine, grpc::CallbackServerContext* context,
                                           const CallerRef& caller,
                                           const v1::AcknowledgeFrameRequest* request,
                                           v1::AcknowledgeFrameResponse* response);
grpc::ServerUnaryReactor* CloseSession(Engine& engine, grpc::CallbackServerContext* context,
                                       const CallerRef& caller,
                                       const v1::CloseSessionRequest* request,
                                       v1::CloseSessionResponse* response);
grpc::ServerUnaryReactor* RenderImage(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::RenderImageRequest* request,
                                      v1::RenderImageResponse* response);
grpc::ServerWriteReactor<v1::RenderImageEvent>* RenderImageWithProgress(
    Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
    const v1::RenderImageRequest* request);

}  // namespace thunderhead::service
