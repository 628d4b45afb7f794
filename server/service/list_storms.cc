#include "service/finished.h"
#include "service/handlers.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* ListStorms(Engine& engine, grpc::CallbackServerContext* context,
                                     const v1::ListStormsRequest* /*request*/,
                                     v1::ListStormsResponse* response) {
  for (const volume::StormInfo& storm : engine.store.Storms()) {
    v1::StormSummary& summary = *response->add_storms();
    summary.set_id(storm.id);
    summary.set_title(storm.title);
    summary.set_time_count(static_cast<std::uint32_t>(storm.times.size()));
  }
  return Finished(context, absl::OkStatus());
}

}  // namespace thunderhead::service
