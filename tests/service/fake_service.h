// A server that uses the fakes of fake_engine.h, and a viewer that collects the messages of a
// stream.
#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/time_source.h"
#include "service/server.h"
#include "tests/service/fake_engine.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::testing {

// A duration longer than any test advances its time.
inline constexpr std::chrono::hours kYears{24 * 365 * 20};

// Returns options of a server that uses `time`, which must outlive the server. Timeouts that the
// test does not change never expire, however slow the machine is and however far a test advances
// the time.
service::ServerOptions Patient(const base::TimeSource& time = base::SteadyTime());

// A server that uses the fakes, and a gRPC stub to call it.
class FakeService {
 public:
  explicit FakeService(const service::ServerOptions& options = Patient());
  ~FakeService();

  service::Server& server() { return *server_; }
  v1::ThunderheadService::Stub& stub() { return *stub_; }

  // Opens a session with a small picture and returns its id.
  std::string Open(const v1::Scene& scene);
  std::uint64_t Update(const std::string& session_id, const v1::Scene& scene);

  const std::shared_ptr<FakeStormStore> store = std::make_shared<FakeStormStore>();
  const std::shared_ptr<FakeMachine> machine = std::make_shared<FakeMachine>();

 private:
  std::unique_ptr<service::Server> server_;
  std::unique_ptr<v1::ThunderheadService::Stub> stub_;
};

// Returns a scene of 64 x 36 pixels and 16 slices.
v1::Scene SmallScene();

// A viewer that watches a session on its own thread. It acknowledges every frame at once unless
// configured otherwise.
class Watcher {
 public:
  Watcher(v1::ThunderheadService::Stub& stub, std::string session_id, bool acknowledges = true);
  ~Watcher();

  // Waits until `wanted` is true for the messages so far, for at most `patience`.
  bool Await(const std::function<bool(const std::vector<v1::WatchFramesResponse>&)>& wanted,
             std::chrono::seconds patience = kPatience);
  // Waits for a frame whose scene revision is at least `revision`. If `refined` is true, the frame
  // must also have full quality.
  bool AwaitFrame(std::uint64_t revision, bool refined);
  std::vector<v1::WatchFramesResponse> Messages();
  v1::Frame NewestFrame();

  void Acknowledge(std::uint64_t sequence);
  void Cancel() { context_.TryCancel(); }
  // Waits for the stream to end.
  grpc::Status End();

 private:
  void Run();

  v1::ThunderheadService::Stub& stub_;
  const std::string session_id_;
  const bool acknowledges_;
  grpc::ClientContext context_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<v1::WatchFramesResponse> messages_;
  grpc::Status end_;
  std::thread thread_;
};

// Calls one rpc with a deadline: Call(stub, &Stub::ListStorms, request, &response).
template <typename Stub, typename Method, typename Request, typename Response>
grpc::Status Call(Stub& stub, Method method, const Request& request, Response* response) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  return (stub.*method)(&context, request, response);
}

}  // namespace thunderhead::testing
