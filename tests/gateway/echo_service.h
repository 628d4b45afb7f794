// The test service of echo.proto behind a gateway, and the counts of its calls.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "echo.grpc.pb.h"
#include "gateway/gateway.h"
#include "grpcpp/channel.h"
#include "grpcpp/server.h"

namespace thunderhead::gateway::test {

struct EchoRecord {
  std::atomic<int> started = 0;
  std::atomic<int> read = 0;
  std::atomic<int> written = 0;
  std::atomic<int> cancelled = 0;
  std::atomic<int> done = 0;
};

class EchoService final : public Echo::CallbackService {
 public:
  EchoRecord& Record() { return record_; }

  grpc::ServerUnaryReactor* Say(grpc::CallbackServerContext* context, const SayRequest* request,
                                SayResponse* response) override;
  grpc::ServerWriteReactor<CountResponse>* Count(grpc::CallbackServerContext* context,
                                                 const CountRequest* request) override;
  grpc::ServerWriteReactor<CountResponse>* Fail(grpc::CallbackServerContext* context,
                                                const FailRequest* request) override;
  grpc::ServerUnaryReactor* FailOnce(grpc::CallbackServerContext* context,
                                     const FailRequest* request, SayResponse* response) override;
  grpc::ServerUnaryReactor* Metadata(grpc::CallbackServerContext* context,
                                     const MetadataRequest* request,
                                     MetadataResponse* response) override;
  grpc::ServerBidiReactor<ConverseRequest, ConverseResponse>* Converse(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* Wait(grpc::CallbackServerContext* context, const WaitRequest* request,
                                 SayResponse* response) override;

 private:
  EchoRecord record_;
};

// The service, its server and a gateway to it, by a Unix socket as in the program.
class EchoSite {
 public:
  static std::unique_ptr<EchoSite> Start(const GatewayOptions& options = {});
  ~EchoSite();

  EchoRecord& Record() { return service_.Record(); }
  const Gateway& Front() const { return *gateway_; }
  uint16_t Port() const { return gateway_->Port(); }
  void StopGateway() { gateway_.reset(); }
  void StopServer();

 private:
  EchoSite() = default;

  EchoService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace thunderhead::gateway::test
