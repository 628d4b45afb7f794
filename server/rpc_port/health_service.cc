#include "rpc_port/health_service.h"

namespace thunderhead::rpc_port {

grpc::ServerUnaryReactor* HealthService::Check(grpc::CallbackServerContext* context,
                                               const grpc::health::v1::HealthCheckRequest* request,
                                               grpc::health::v1::HealthCheckResponse* response) {
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  if (!request->service().empty() && request->service() != service_) {
    reactor->Finish(
        {grpc::StatusCode::NOT_FOUND, "health is known only for \"" + service_ +
                                          "\" and, without a name, for the whole server"});
    return reactor;
  }
  using Response = grpc::health::v1::HealthCheckResponse;
  response->set_status(serving_ ? Response::SERVING : Response::NOT_SERVING);
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

}  // namespace thunderhead::rpc_port
