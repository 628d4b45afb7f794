#include "service/finished.h"
#include "service/handlers.h"
#include "service/scene_messages.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* ListStorms(Engine& engine, grpc::CallbackServerContext* context,
                                     const v1::ListStormsRequest* /*request*/,
                                     v1::ListStormsResponse* response) {
  for (const volume::StormInfo* storm : engine.store.Storms()) {
    ToMessage(*storm, *response->add_storms());
  }
  return Finished(context, absl::OkStatus());
}

}  // namespace thunderhead::service
