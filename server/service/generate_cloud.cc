#include <stop_token>

#include "base/guarded.h"
#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/cloud_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

absl::StatusOr<clouds::CloudShape> Check(const v1::GenerateCloudRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  return ShapeOf(request);
}

absl::Status Make(Engine& engine, const std::string& owner, const clouds::CloudShape& shape,
                  const v1::GenerateCloudRequest& request, grpc::CallbackServerContext& context,
                  v1::GenerateCloudResponse& response) {
  std::stop_source stop;
  const auto observe = [&](double) {
    if (context.IsCancelled()) stop.request_stop();
  };
  THUNDERHEAD_ASSIGN_OR_RETURN(
      storm_store::StormInfoPtr storm,
      engine.clouds.Make(shape, OriginOf(request), observe, stop.get_token(), owner));
  ToMessage(*storm, *response.mutable_storm());
  response.mutable_storm()->set_deletable(true);
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* GenerateCloud(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::GenerateCloudRequest* request,
                                        v1::GenerateCloudResponse* response) {
  auto shape = Check(*request);
  if (!shape.ok()) return rpc_port::Refused(context, *caller, shape.status());
  auto* const answer = new rpc_port::Answer(context, engine.limits, caller, *response);
  engine.executor.Submit(
      caller->identity().name, [=, &engine, shape = *std::move(shape)](const absl::Status& status) {
        const absl::Status made = status.ok() ? base::Guarded([&] {
          return Make(engine, caller->identity().name, shape, *request, *context, *response);
        })
                                              : status;
        caller->Report("GenerateCloud", made);
        answer->Give(made);
      });
  return answer;
}

}  // namespace thunderhead::service
