// A participant of a session, who uses the call Interact. A separate thread collects the call's
// messages and acknowledges frames.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "google/rpc/status.pb.h"
#include "tests/service/fake_service.h"

namespace thunderhead::testing {

struct InteractingOptions {
  std::string name;
  bool hidden = false;
  bool acknowledges = true;
  std::vector<v1::Codec> codecs{};
  bool saves_bytes = false;
  std::string participant_key;
  bool answers_checks = true;  // if true, answers the server's connection checks with Alive
  bool is_old = false;  // acts like an old client, which supports neither incremental marks nor
                        // connection checks
};

// Returns the reason in a refusal's details; an empty text if the details contain no reason.
std::string ReasonOf(const google::rpc::Status& refusal);
std::string ReasonOf(const grpc::Status& refusal);
// Returns the delay before a retry in a refusal's details; 0 if the details contain no delay.
std::chrono::milliseconds RetryAfterOf(const google::rpc::Status& refusal);

class Interacting {
 public:
  using Options = InteractingOptions;

  Interacting(v1::ThunderheadService::Stub& stub, const std::string& key, Options options = {});
  ~Interacting();

  // Sends a message and returns its request_id.
  std::uint64_t Send(v1::InteractRequest request);

  using Messages = std::vector<v1::InteractResponse>;
  // Waits until `wanted` is true for the messages so far, for at most `patience`.
  bool Await(const std::function<bool(const Messages&)>& wanted,
             std::chrono::seconds patience = kPatience);
  // Waits for a message of the kind `part`, and returns the newest such message.
  v1::InteractResponse AwaitNewest(v1::InteractResponse::MessageCase part);
  // Returns the answer to the request, SceneTaken or Refused.
  v1::InteractResponse Answer(std::uint64_t request_id);
  // Returns the code of the refusal that answers the request; OK for SceneTaken.
  grpc::StatusCode AnswerCode(std::uint64_t request_id);
  // Waits until `wanted` is true for the newest presence.
  bool AwaitPresence(const std::function<bool(const v1::Presence&)>& wanted);
  // Waits until the newest scene's revision is at least `revision`, and returns this scene.
  v1::Scene AwaitScene(std::uint64_t revision);
  // Waits for a frame whose scene revision is at least `revision`.
  bool AwaitFrame(std::uint64_t revision, bool own_view = false);
  Messages All();

  // Waits until `wanted` returns true for all marks of the session. Incremental messages are
  // applied to them first.
  bool AwaitMarks(const std::function<bool(const v1::Marks&)>& wanted);
  // Returns the messages with marks as they were received.
  std::vector<v1::Marks> MarksAsTold();

  // The id of this participant, known once it has joined.
  std::uint64_t viewer_id();
  std::string participant_key();

  void Leave();  // leaves the session by half-closing the call
  void Cancel() { context_.TryCancel(); }
  // Waits for the call to end.
  grpc::Status End();

 private:
  void Run();

  const Options options_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::InteractRequest, v1::InteractResponse>> call_;
  std::atomic<std::uint64_t> viewer_id_{0};
  std::mutex write_mutex_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Messages messages_;
  v1::Marks marks_;  // all marks, with incremental messages applied
  std::vector<v1::Marks> marks_as_told_;
  std::uint64_t request_count_ = 0;
  grpc::Status end_;
  std::thread thread_;
};

}  // namespace thunderhead::testing
