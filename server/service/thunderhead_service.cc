#include "service/thunderhead_service.h"

#include <utility>

#include "rpc_port/admission.h"
#include "service/handlers.h"
#include "service/interact/interact.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::service {
namespace {

// The base class of the service. Interact uses bytes and all other calls use messages. For each
// call, gRPC needs a generated class in this chain.
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
  ThunderheadService(Engine& engine, access::AccessControl& access_control,
                     rpc_port::ConnectionCalls& calls)
      : engine_(engine), access_control_(access_control), entrance_(access_control, calls) {}

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override {
    return entrance_.Unary("GetServerInfo", context, [&](const CallerRef& caller) {
      return service::GetServerInfo(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* ListStorms(grpc::CallbackServerContext* context,
                                       const v1::ListStormsRequest* request,
                                       v1::ListStormsResponse* response) override {
    return entrance_.Unary("ListStorms", context, [&](const CallerRef& caller) {
      return service::ListStorms(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* DescribeStorm(grpc::CallbackServerContext* context,
                                          const v1::DescribeStormRequest* request,
                                          v1::DescribeStormResponse* response) override {
    return entrance_.Unary("DescribeStorm", context, [&](const CallerRef& caller) {
      return service::DescribeStorm(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* GetStormMap(grpc::CallbackServerContext* context,
                                        const v1::GetStormMapRequest* request,
                                        v1::GetStormMapResponse* response) override {
    return entrance_.Unary("GetStormMap", context, [&](const CallerRef& caller) {
      return service::GetStormMap(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* ProbeRay(grpc::CallbackServerContext* context,
                                     const v1::ProbeRayRequest* request,
                                     v1::ProbeRayResponse* response) override {
    return entrance_.Unary("ProbeRay", context, [&](const CallerRef& caller) {
      return service::ProbeRay(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* GenerateCloud(grpc::CallbackServerContext* context,
                                          const v1::GenerateCloudRequest* request,
                                          v1::GenerateCloudResponse* response) override {
    return entrance_.Unary("GenerateCloud", context, [&](const CallerRef& caller) {
      return service::GenerateCloud(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* DeleteCloud(grpc::CallbackServerContext* context,
                                        const v1::DeleteCloudRequest* request,
                                        v1::DeleteCloudResponse* response) override {
    return entrance_.Unary("DeleteCloud", context, [&](const CallerRef& caller) {
      return service::DeleteCloud(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* CreateSession(grpc::CallbackServerContext* context,
                                          const v1::CreateSessionRequest* request,
                                          v1::CreateSessionResponse* response) override {
    return entrance_.Unary("CreateSession", context, [&](const CallerRef& caller) {
      return service::CreateSession(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* UpdateScene(grpc::CallbackServerContext* context,
                                        const v1::UpdateSceneRequest* request,
                                        v1::UpdateSceneResponse* response) override {
    return entrance_.Unary("UpdateScene", context, [&](const CallerRef& caller) {
      return service::UpdateScene(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* AcknowledgeFrame(grpc::CallbackServerContext* context,
                                             const v1::AcknowledgeFrameRequest* request,
                                             v1::AcknowledgeFrameResponse* response) override {
    return entrance_.Unary("AcknowledgeFrame", context, [&](const CallerRef& caller) {
      return service::AcknowledgeFrame(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* CloseSession(grpc::CallbackServerContext* context,
                                         const v1::CloseSessionRequest* request,
                                         v1::CloseSessionResponse* response) override {
    return entrance_.Unary("CloseSession", context, [&](const CallerRef& caller) {
      return service::CloseSession(engine_, context, caller, request, response);
    });
  }

  grpc::ServerUnaryReactor* RenderImage(grpc::CallbackServerContext* context,
                                        const v1::RenderImageRequest* request,
                                        v1::RenderImageResponse* response) override {
    return entrance_.Unary("RenderImage", context, [&](const CallerRef& caller) {
      return service::RenderImage(engine_, context, caller, request, response);
    });
  }

  InteractReactor* Interact(grpc::CallbackServerContext* context) override {
    return entrance_.Stream<InteractReactor>("Interact", context, [&](CallerRef caller) {
      return service::Interact(engine_, context, std::move(caller),
                               access_control_.limits().requests_per_second);
    });
  }

  grpc::ServerWriteReactor<v1::RenderImageEvent>* RenderImageWithProgress(
      grpc::CallbackServerContext* context, const v1::RenderImageRequest* request) override {
    return entrance_.Stream<grpc::ServerWriteReactor<v1::RenderImageEvent>>(
        "RenderImageWithProgress", context, [&](CallerRef caller) {
          return service::RenderImageWithProgress(engine_, context, std::move(caller), request);
        });
  }

  grpc::ServerWriteReactor<v1::WatchFramesResponse>* WatchFrames(
      grpc::CallbackServerContext* context, const v1::WatchFramesRequest* request) override {
    return entrance_.Stream<grpc::ServerWriteReactor<v1::WatchFramesResponse>>(
        "WatchFrames", context, [&](CallerRef caller) {
          return service::WatchFrames(engine_, context, std::move(caller), request);
        });
  }

 private:
  Engine& engine_;
  access::AccessControl& access_control_;
  const rpc_port::Entrance entrance_;
};

}  // namespace

std::unique_ptr<grpc::Service> MakeThunderheadService(Engine& engine,
                                                      access::AccessControl& access_control,
                                                      rpc_port::ConnectionCalls& calls) {
  return std::make_unique<ThunderheadService>(engine, access_control, calls);
}

}  // namespace thunderhead::service
