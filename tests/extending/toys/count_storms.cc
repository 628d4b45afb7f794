// The handler of a call that only tests/extending knows.
#include <algorithm>

#include "base/status.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

absl::Status Count(Engine& engine, const v1::CountStormsRequest& request,
                   v1::CountStormsResponse* response) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  v1::CountStormsRequest filled = request;
  FillDefaults(filled);
  const auto storms = static_cast<std::uint32_t>(engine.store.Storms().size());
  response->set_storms(std::min(storms, filled.at_most()));
  return absl::OkStatus();
}

}  // namespace

grpc::ServerUnaryReactor* CountStorms(Engine& engine, grpc::CallbackServerContext* context,
                                      const CallerRef& caller,
                                      const v1::CountStormsRequest* request,
                                      v1::CountStormsResponse* response) {
  return rpc_port::Finished(engine.limits, context, caller, Count(engine, *request, response),
                            *response);
}

}  // namespace thunderhead::service
