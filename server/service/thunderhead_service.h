// The service as gRPC calls it: asks the door about every call, and dispatches it to its handler.
#pragma once

#include "access/door.h"
#include "service/engine.h"
#include "service/interact.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::service {

// The calls by messages, and Interact by bytes. This takes gRPC's generated class for each call.
using Generated = v1::ThunderheadService;
using Calls = Generated::WithCallbackMethod_GetServerInfo<Generated::WithCallbackMethod_ListStorms<
    Generated::WithCallbackMethod_DescribeStorm<Generated::WithCallbackMethod_GenerateCloud<
        Generated::WithCallbackMethod_DeleteCloud<Generated::WithCallbackMethod_CreateSession<
            Generated::WithCallbackMethod_UpdateScene<Generated::WithCallbackMethod_WatchFrames<
                Generated::WithCallbackMethod_AcknowledgeFrame<
                    Generated::WithCallbackMethod_CloseSession<
                        Generated::WithCallbackMethod_RenderImage<
                            Generated::WithCallbackMethod_RenderImageWithProgress<
                                Generated::WithCallbackMethod_GetStormMap<
                                    Generated::WithCallbackMethod_ProbeRay<
                                        Generated::WithRawCallbackMethod_Interact<
                                            Generated::Service>>>>>>>>>>>>>>>;

class ThunderheadService final : public Calls {
 public:
  ThunderheadService(Engine& engine, access::Door& door) : engine_(engine), door_(door) {}

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override;
  grpc::ServerUnaryReactor* ListStorms(grpc::CallbackServerContext* context,
                                       const v1::ListStormsRequest* request,
                                       v1::ListStormsResponse* response) override;
  grpc::ServerUnaryReactor* DescribeStorm(grpc::CallbackServerContext* context,
                                          const v1::DescribeStormRequest* request,
                                          v1::DescribeStormResponse* response) override;
  grpc::ServerUnaryReactor* GetStormMap(grpc::CallbackServerContext* context,
                                        const v1::GetStormMapRequest* request,
                                        v1::GetStormMapResponse* response) override;
  grpc::ServerUnaryReactor* ProbeRay(grpc::CallbackServerContext* context,
                                     const v1::ProbeRayRequest* request,
                                     v1::ProbeRayResponse* response) override;
  grpc::ServerUnaryReactor* GenerateCloud(grpc::CallbackServerContext* context,
                                          const v1::GenerateCloudRequest* request,
                                          v1::GenerateCloudResponse* response) override;
  grpc::ServerUnaryReactor* DeleteCloud(grpc::CallbackServerContext* context,
                                        const v1::DeleteCloudRequest* request,
                                        v1::DeleteCloudResponse* response) override;
  grpc::ServerUnaryReactor* CreateSession(grpc::CallbackServerContext* context,
                                          const v1::CreateSessionRequest* request,
                                          v1::CreateSessionResponse* response) override;
  InteractReactor* Interact(grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* UpdateScene(grpc::CallbackServerContext* context,
                                        const v1::UpdateSceneRequest* request,
                                        v1::UpdateSceneResponse* response) override;
  grpc::ServerUnaryReactor* AcknowledgeFrame(grpc::CallbackServerContext* context,
                                             const v1::AcknowledgeFrameRequest* request,
                                             v1::AcknowledgeFrameResponse* response) override;
  grpc::ServerUnaryReactor* CloseSession(grpc::CallbackServerContext* context,
                                         const v1::CloseSessionRequest* request,
                                         v1::CloseSessionResponse* response) override;
  grpc::ServerUnaryReactor* RenderImage(grpc::CallbackServerContext* context,
                                        const v1::RenderImageRequest* request,
                                        v1::RenderImageResponse* response) override;
  grpc::ServerWriteReactor<v1::RenderImageEvent>* RenderImageWithProgress(
      grpc::CallbackServerContext* context, const v1::RenderImageRequest* request) override;
  grpc::ServerWriteReactor<v1::WatchFramesResponse>* WatchFrames(
      grpc::CallbackServerContext* context, const v1::WatchFramesRequest* request) override;

 private:
  Engine& engine_;
  access::Door& door_;
};

}  // namespace thunderhead::service
