#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

absl::StatusOr<storm_store::StormInfoPtr> CheckDescribe(const Engine& engine,
                                                        const v1::DescribeStormRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  THUNDERHEAD_ASSIGN_OR_RETURN(storm_store::StormInfoPtr storm,
                               FindStorm(engine.store, request.storm_id()));
  THUNDERHEAD_RETURN_IF_ERROR(CheckTime(*storm, request.time_index(), "time_index"));
  return storm;
}

absl::Status Describe(Engine& engine, const storm_store::StormInfo& storm, int time_index,
                      v1::DescribeStormResponse& response) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto fields,
                               ReadFields(engine.store, storm.id, time_index, "storm_id"));
  ToMessage(storm, *fields, time_index, *response.mutable_storm());
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* DescribeStorm(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::DescribeStormRequest* request,
                                        v1::DescribeStormResponse* response) {
  const auto storm = CheckDescribe(engine, *request);
  if (!storm.ok()) return rpc_port::Refused(context, *caller, storm.status());
  return rpc_port::FinishedBy(
      engine.executor, engine.limits, context, caller, *response, [=, &engine] {
        return Describe(engine, **storm, static_cast<int>(request->time_index()), *response);
      });
}

}  // namespace thunderhead::service
