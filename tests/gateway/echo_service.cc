#include "tests/gateway/echo_service.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "grpc/grpc.h"
#include "grpcpp/alarm.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/security/server_credentials.h"
#include "grpcpp/server_builder.h"
#include "grpcpp/support/channel_arguments.h"

namespace thunderhead::gateway::test {
namespace {

grpc::Status FailureOf(const FailRequest& request) {
  return {static_cast<grpc::StatusCode>(request.code()), request.message(), request.details()};
}

// A call that writes `count` responses with a pause before each, then finishes with `end`.
class Counter final : public grpc::ServerWriteReactor<CountResponse>, private HeldCall {
 public:
  Counter(EchoRecord& record, HeldCalls& held, CountRequest request, grpc::Status end)
      : record_(record), held_(held), request_(std::move(request)), end_(std::move(end)) {
    ++record_.started;
    held_.Add(this);
    StartSendInitialMetadata();
    Next();
  }

 private:
  void Release() override {
    {
      const std::lock_guard lock(mutex_);
      released_ = true;
      if (!std::exchange(is_held_, false)) return;
    }
    Next();
  }

  void OnWriteDone(bool ok) override {
    if (!ok) {
      Finish(grpc::Status::CANCELLED);
      return;
    }
    ++record_.written;
    Next();
  }
  void OnCancel() override {
    ++record_.cancelled;
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    if (std::exchange(is_held_, false)) {
      Finish(grpc::Status::CANCELLED);
    } else {
      alarm_.Cancel();
    }
  }
  void OnDone() override {
    held_.Remove(this);
    ++record_.done;
    delete this;
  }

  void Next() {
    const std::lock_guard lock(mutex_);
    if (cancelled_ || next_ == request_.count()) {
      Finish(cancelled_ ? grpc::Status::CANCELLED : end_);
      return;
    }
    is_held_ = !released_ && request_.has_hold_after() && next_ == request_.hold_after();
    if (is_held_) return;
    const auto pause = std::chrono::milliseconds(request_.interval_ms());
    alarm_.Set(std::chrono::system_clock::now() + pause, [this](bool expired) {
      if (!expired) {
        Finish(grpc::Status::CANCELLED);
        return;
      }
      response_.set_index(next_);
      response_.set_payload(std::string(request_.payload_bytes(), static_cast<char>(next_)));
      ++next_;
      StartWrite(&response_);
    });
  }

  EchoRecord& record_;
  HeldCalls& held_;
  const CountRequest request_;
  const grpc::Status end_;
  std::mutex mutex_;  // guards against a cancellation during the next alarm
  bool cancelled_ = false;
  bool is_held_ = false;
  bool released_ = false;
  grpc::Alarm alarm_;
  CountResponse response_;
  uint32_t next_ = 0;
};

// A call that reads a request once the responses to the previous request are written.
//
// Reads, writes and Finish begin under the lock, because gRPC ends the process if an operation
// begins after Finish.
class Conversation final : public grpc::ServerBidiReactor<ConverseRequest, ConverseResponse> {
 public:
  explicit Conversation(EchoRecord& record) : record_(record) {
    ++record_.started;
    StartRead(&request_);
  }

 private:
  void OnReadDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    if (!ok) return End(grpc::Status::OK);
    ++record_.read;
    response_.set_payload(request_.payload());
    responses_left_ = std::uint64_t{request_.repeats()} + (request_.has_end() ? 0 : 1);
    Next();
  }
  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    if (!ok) return End(grpc::Status::CANCELLED);
    ++record_.written;
    Next();
  }
  void OnCancel() override {
    ++record_.cancelled;
    const std::lock_guard lock(mutex_);
    End(grpc::Status::CANCELLED);
  }
  void OnDone() override {
    ++record_.done;
    delete this;
  }

  void Next() {
    if (ended_) return;
    if (responses_left_ > 0) {
      --responses_left_;
      StartWrite(&response_);
    } else if (request_.has_end()) {
      End(FailureOf(request_.end()));
    } else if (!request_.read_no_more()) {
      StartRead(&request_);
    }
  }
  void End(const grpc::Status& status) {
    if (ended_) return;
    ended_ = true;
    Finish(status);
  }

  EchoRecord& record_;
  ConverseRequest request_;
  ConverseResponse response_;
  std::mutex mutex_;  // guards against a cancellation while the next operation begins
  std::uint64_t responses_left_ = 0;
  bool ended_ = false;
};

class Waiter final : public grpc::ServerUnaryReactor {
 public:
  explicit Waiter(EchoRecord& record) : record_(record) { ++record_.started; }

 private:
  void OnCancel() override {
    ++record_.cancelled;
    Finish(grpc::Status::CANCELLED);
  }
  void OnDone() override {
    ++record_.done;
    delete this;
  }

  EchoRecord& record_;
};

}  // namespace

grpc::ServerUnaryReactor* EchoService::Say(grpc::CallbackServerContext* context,
                                           const SayRequest* request, SayResponse* response) {
  response->set_text(request->text());
  response->set_payload(request->payload());
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

grpc::ServerWriteReactor<CountResponse>* EchoService::Count(grpc::CallbackServerContext*,
                                                            const CountRequest* request) {
  return new Counter(record_, held_, *request, grpc::Status::OK);
}

grpc::ServerWriteReactor<CountResponse>* EchoService::Fail(grpc::CallbackServerContext* context,
                                                           const FailRequest* request) {
  context->AddTrailingMetadata("failed-after", absl::StrCat(request->messages()));
  CountRequest count;
  count.set_count(request->messages());
  return new Counter(record_, held_, count, FailureOf(*request));
}

grpc::ServerUnaryReactor* EchoService::FailOnce(grpc::CallbackServerContext* context,
                                                const FailRequest* request, SayResponse*) {
  context->AddTrailingMetadata("failed-after", "0");
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(FailureOf(*request));
  return reactor;
}

grpc::ServerUnaryReactor* EchoService::Metadata(grpc::CallbackServerContext* context,
                                                const MetadataRequest*,
                                                MetadataResponse* response) {
  for (const auto& [key, data] : context->client_metadata()) {
    const std::string name(key.data(), key.size());
    const std::string value(data.data(), data.size());
    Entry* const entry = response->add_entries();
    entry->set_name(name);
    entry->set_value(value);
    if (name.rfind("echo-", 0) == 0) {
      context->AddInitialMetadata(name, value);
      context->AddTrailingMetadata(absl::StrCat("trailing-", name), value);
    }
  }
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

grpc::ServerBidiReactor<ConverseRequest, ConverseResponse>* EchoService::Converse(
    grpc::CallbackServerContext* context) {
  context->AddTrailingMetadata("conversed", "yes");
  return new Conversation(record_);
}

grpc::ServerUnaryReactor* EchoService::Wait(grpc::CallbackServerContext*, const WaitRequest*,
                                            SayResponse*) {
  return new Waiter(record_);
}

std::unique_ptr<EchoSite> EchoSite::Start(const GatewayOptions& options) {
  // When its last object is gone, gRPC 1.51 often waits for a polling thread that sleeps up to 10
  // s. If gRPC stays initialised, it does not wait.
  static const bool is_kept = (grpc_init(), true);
  static_cast<void>(is_kept);
  std::unique_ptr<EchoSite> site(new EchoSite());
  // The socket is in Linux's abstract namespace, which needs no file.
  static std::atomic<int> count = 0;
  const std::string address = absl::StrCat("unix-abstract:echo-", getpid(), "-", ++count);
  grpc::ServerBuilder builder;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials());
  builder.RegisterService(&site->service_);
  site->server_ = builder.BuildAndStart();
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  const auto channel =
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  absl::StatusOr<std::unique_ptr<Gateway>> gateway = Gateway::Start(options, channel);
  THUNDERHEAD_CHECK(gateway.ok(), gateway.status().ToString());
  site->gateway_ = *std::move(gateway);
  return site;
}

EchoSite::~EchoSite() {
  gateway_.reset();
  StopServer();
}

void EchoSite::StopServer() {
  // Cancels the calls at once.
  server_->Shutdown(std::chrono::system_clock::now());
}

}  // namespace thunderhead::gateway::test
