// A fake service in this process, controlled by the test. It keeps one session, records the
// clients' requests, and sends the responses that the test gives it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/wait_for.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"
#include "thunderhead_client/connection.h"

namespace thunderhead::client::testing {

inline constexpr auto kPatience = thunderhead::testing::kHangLimit;

class FakeService final : public v1::ThunderheadService::Service {
 public:
  using Requests = std::vector<v1::InteractRequest>;

  FakeService();
  ~FakeService() override;

  std::shared_ptr<const Connection> Connect() const;
  // Stop() ends the server. Start() starts it again on the same port with the same sessions.
  void Stop();
  void Start();

  // Await() waits until `wanted`, which gets the list of all requests of all calls so far, returns
  // true. All() returns this list.
  bool Await(const std::function<bool(const Requests&)>& wanted);
  Requests All();
  // Returns the metadata "authorization" of the last call.
  std::string authorization();
  int opened();  // number of sessions that clients have opened
  int joined();  // number of Interact calls that have joined

  // Sends a response to the newest call.
  void Send(v1::InteractResponse response);
  // Sends a presence message that lists the client and `others`, all of them presenters. The viewer
  // `steering_viewer_id` steers; 0 means that no viewer steers.
  void SendPresence(std::uint64_t steering_viewer_id,
                    const std::vector<std::uint64_t>& others = {});
  void SendScene(const v1::Scene& scene, std::uint64_t revision);
  // Ends the newest call.
  void EndCall(const grpc::Status& status);

  bool answers_scenes = true;  // accepts each update of the scene at once
  // Makes the response to the first scene of a session. The default accepts it.
  std::function<grpc::Status(const v1::Scene&)> answer_opening;
  // Makes the response to a request for a storm's description. The default is NOT_FOUND.
  std::function<grpc::Status(const v1::DescribeStormRequest&, v1::DescribeStormResponse&)>
      answer_description;
  // The response's `durable` for the opened sessions; no value leaves the field unset.
  std::optional<bool> durable;
  bool forgets_sessions = false;  // joins fail with NOT_FOUND until another session is opened

  static constexpr char kPresenterKey[] = "presenter-key";
  static constexpr char kViewerKey[] = "viewer-key";
  static constexpr std::uint64_t kClient = 7;
  std::atomic<std::uint64_t> client{kClient};  // the viewer id that the next call gets

 private:
  using Stream = grpc::ServerReaderWriter<v1::InteractResponse, v1::InteractRequest>;
  struct Call;

  grpc::Status CreateSession(grpc::ServerContext* context, const v1::CreateSessionRequest* request,
                             v1::CreateSessionResponse* response) override;
  grpc::Status Interact(grpc::ServerContext* context, Stream* stream) override;
  grpc::Status GetServerInfo(grpc::ServerContext* context, const v1::GetServerInfoRequest* request,
                             v1::GetServerInfoResponse* response) override;
  grpc::Status DescribeStorm(grpc::ServerContext* context, const v1::DescribeStormRequest* request,
                             v1::DescribeStormResponse* response) override;
  void Answer(Call& call, const v1::InteractRequest& request);

  std::mutex mutex_;
  std::condition_variable changed_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  Requests requests_;
  std::string authorization_;
  int opened_ = 0;
  int joined_ = 0;
  Call* call_ = nullptr;
};

}  // namespace thunderhead::client::testing
