#include "base/version.h"
#include "rpc_port/finished.h"
#include "service/handlers.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::service {

grpc::ServerUnaryReactor* GetServerInfo(Engine& engine, grpc::CallbackServerContext* context,
                                        const CallerRef& caller,
                                        const v1::GetServerInfoRequest* /*request*/,
                                        v1::GetServerInfoResponse* response) {
  const drawing::DeviceInfo& device = engine.loop.Device();
  response->set_version(base::Version());
  response->set_gl_renderer(device.gl_renderer);
  response->set_gl_version(device.gl_version);
  response->set_device(device.device);
  response->set_max_sessions(static_cast<std::uint32_t>(engine.sessions.max_sessions()));
  for (const scene::TechniqueInfo& technique : engine.loop.Techniques()) {
    ToMessage(technique, *response->add_techniques());
  }
  AddPresets(*response);
  return rpc_port::Finished(engine.limits, context, caller, absl::OkStatus(), *response);
}

}  // namespace thunderhead::service
