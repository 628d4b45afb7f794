// The test service of echo.proto behind a gateway, and the counts of its calls.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <set>
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

// A call that waits until the test releases it.
class HeldCall {
 public:
  virtual ~HeldCall() = default;
  virtual void Release() = 0;
};

// The calls that may be held. It is safe to use from any thread.
class HeldCalls {
 public:
  void Add(HeldCall* call) {
    const std::lock_guard lock(mutex_);
    calls_.insert(call);
  }
  void Remove(HeldCall* call) {
    const std::lock_guard lock(mutex_);
    calls_.erase(call);
  }
  void ReleaseAll() {
    const std::lock_guard lock(mutex_);
    for (HeldCall* const call : calls_) call->Release();
  }

 private:
  std::mutex mutex_;
  std::set<HeldCall*> calls_;
};

class EchoService final : public Echo::CallbackService {
 public:
  EchoRecord& Record() { return record_; }
  HeldCalls& Held() { return held_; }

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
  HeldCalls held_;
};

// The service, its server and a gateway to it, connected by a Unix socket as in the program.
class EchoSite {
 public:
  static std::unique_ptr<EchoSite> Start(const GatewayOptions& options = {});
  ~EchoSite();

  EchoRecord& Record() { return service_.Record(); }
  // Lets the calls continue that CountRequest.hold_after holds.
  void Release() { service_.Held().ReleaseAll(); }
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
