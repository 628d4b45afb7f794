// Answers gRPC's health checks. Unlike gRPC's own health service, it does not offer the streaming
// method Watch. Health checks need no token and count towards no quota, so anyone could keep such
// streams open. Clients that call Watch interpret UNIMPLEMENTED as "serving".
#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <string>
#include <utility>

#include "grpc/health/v1/health.grpc.pb.h"

namespace thunderhead::rpc_port {

class HealthService final : public grpc::health::v1::Health::CallbackService {
 public:
  // Reports the health of the whole server, under an empty name and under the full name `service`.
  explicit HealthService(std::string service) : service_(std::move(service)) {}

  void SetServing(bool serving) { serving_ = serving; }

  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context,
                                  const grpc::health::v1::HealthCheckRequest* request,
                                  grpc::health::v1::HealthCheckResponse* response) override;

 private:
  const std::string service_;
  std::atomic<bool> serving_ = false;
};

}  // namespace thunderhead::rpc_port
