// Serves gRPC's reflection, by which tools such as grpcurl ask for services and messages. gRPC's
// own reflection service is not used, because each of its calls occupies a thread, and CallBudgets
// learns of them too late. Clients that ask for version v1 of the protocol get UNIMPLEMENTED and
// then use this one.
#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <string>
#include <vector>

#include "grpc/reflection/v1alpha/reflection.grpc.pb.h"
#include "rpc_port/port_limits.h"
#include "rpc_port/reflected_services.h"

namespace thunderhead::rpc_port {

class ReflectionService final
    : public grpc::reflection::v1alpha::ServerReflection::CallbackService {
 public:
  using Reactor = grpc::ServerBidiReactor<ReflectedServices::Request, ReflectedServices::Response>;

  // Reports `services`, given by their full names, and reflection itself. `limits` must outlive the
  // object, and the object must outlive the server.
  ReflectionService(const PortLimits& limits, std::vector<std::string> services);

  // Calls need no token. Few can therefore be open at once, and a call is cancelled if its client
  // neither asks nor receives an answer within PortLimits::delivery_time.
  Reactor* ServerReflectionInfo(grpc::CallbackServerContext* context) override;

 private:
  const PortLimits& limits_;
  const ReflectedServices services_;
  std::atomic<int> open_ = 0;  // calls
};

}  // namespace thunderhead::rpc_port
