#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* ListStorms(Engine& engine, grpc::CallbackServerContext* context,
                                     const CallerRef& caller,
                                     const v1::ListStormsRequest* /*request*/,
                                     v1::ListStormsResponse* response) {
  for (const storm_store::StormInfoPtr& storm : engine.store.Storms()) {
    v1::StormSummary& summary = *response->add_storms();
    ToMessage(*storm, summary);
    summary.set_deletable(engine.clouds.Holds(storm->id));
  }
  return rpc_port::Finished(engine.limits, context, caller, absl::OkStatus(), *response);
}

}  // namespace thunderhead::service
