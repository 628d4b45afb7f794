// Tests of access control: every role with every rpc of the descriptor, the limits, and the audit
// log.
#include <grpcpp/generic/generic_stub.h>
#include <openssl/sha.h>

#include <grpcpp/create_channel.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "access/rules.h"
#include "gmock/gmock.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/guarded_service.h"
#include "tests/service/interacting.h"
#include "tests/support/manual_time.h"
#include "tests/support/running_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "thunderhead/v1/job.grpc.pb.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Stub = v1::ThunderheadService::Stub;

// The roles that may call each rpc. Operators may call every rpc and are not listed. The test fails
// if an rpc is missing here.
const std::map<std::string, std::set<std::string>> kMayCall = {
    {"GetServerInfo", {"viewer", "presenter", "pipeline"}},
    {"ListStorms", {"viewer", "presenter", "pipeline"}},
    {"DescribeStorm", {"viewer", "presenter", "pipeline"}},
    {"GetStormMap", {"viewer", "presenter", "pipeline"}},
    {"ProbeRay", {"viewer", "presenter", "pipeline"}},
    {"GenerateCloud", {"presenter"}},
    {"DeleteCloud", {"presenter"}},
    {"CreateSession", {"presenter"}},
    {"Interact", {"viewer", "presenter"}},
    {"UpdateScene", {"presenter"}},
    {"WatchFrames", {"viewer", "presenter"}},
    {"AcknowledgeFrame", {"viewer", "presenter"}},
    {"CloseSession", {"presenter"}},
    {"RenderImage", {"presenter", "pipeline"}},
    {"RenderImageWithProgress", {"presenter", "pipeline"}},
    {"CreateRenderJob", {"presenter", "pipeline"}},
    {"GetRenderJob", {"presenter", "pipeline"}},
    {"ListRenderJobs", {"presenter", "pipeline"}},
    {"WatchRenderJob", {"presenter", "pipeline"}},
    {"CancelRenderJob", {"presenter", "pipeline"}},
    {"FetchRenderResult", {"presenter", "pipeline"}},
};

std::optional<std::chrono::milliseconds> RetryOf(const grpc::Status& status) {
  google::rpc::Status details;
  if (!details.ParseFromString(status.error_details())) return std::nullopt;
  for (const auto& detail : details.details()) {
    google::rpc::RetryInfo retry;
    if (!detail.UnpackTo(&retry)) continue;
    return milliseconds(1000 * retry.retry_delay().seconds() +
                        retry.retry_delay().nanos() / 1'000'000);
  }
  return std::nullopt;
}

TEST(AccessTest, EveryRoleMayCallWhatTheTableSays) {
  GuardedService guarded(Patient(), {.wrong_tokens_per_second = 0});
  std::vector<const google::protobuf::MethodDescriptor*> methods;
  for (const char* name :
       {v1::ThunderheadService::service_full_name(), v1::RenderJobService::service_full_name()}) {
    const auto* const service =
        google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(name);
    ASSERT_NE(service, nullptr);
    for (int i = 0; i < service->method_count(); ++i) methods.push_back(service->method(i));
  }
  ASSERT_EQ(methods.size(), kMayCall.size());
  for (const auto* const described : methods) {
    const std::string method = described->name();
    const std::string& service = described->service()->full_name();
    ASSERT_TRUE(kMayCall.contains(method)) << method << " has no row in this test";
    EXPECT_TRUE(access::HasRule(method)) << method << " has no rule in access/rules.cc";
    for (const std::string& role : kRoles) {
      const bool may = role == "operator" || kMayCall.at(method).contains(role);
      const grpc::StatusCode code = guarded.Ask(method, TokenOf(role), service);
      EXPECT_EQ(code != grpc::StatusCode::PERMISSION_DENIED, may) << role << " " << method;
      EXPECT_NE(code, grpc::StatusCode::UNAUTHENTICATED) << role << " " << method;
    }
    EXPECT_EQ(guarded.Ask(method, "", service), grpc::StatusCode::UNAUTHENTICATED) << method;
    EXPECT_EQ(guarded.Ask(method, "wrong", service), grpc::StatusCode::UNAUTHENTICATED) << method;
  }
}

TEST(AccessTest, RefusalsAndPrivilegedActsAreAudited) {
  GuardedService guarded;
  const auto created = guarded.Create();
  guarded.Ask("ListStorms", "wrong-token-9");
  guarded.Ask("CreateSession", TokenOf("viewer"));
  v1::CloseSessionRequest close;
  close.set_session_id(created.viewer_key());
  v1::CloseSessionResponse closed;
  EXPECT_EQ(guarded.Call("presenter", &Stub::CloseSession, close, &closed).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
  v1::UpdateSceneRequest update;
  update.set_session_id(created.viewer_key());
  v1::UpdateSceneResponse updated;
  EXPECT_EQ(guarded.Call("presenter", &Stub::UpdateScene, update, &updated).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
  close.set_session_id(created.session_id());
  EXPECT_TRUE(guarded.Call("presenter", &Stub::CloseSession, close, &closed).ok());
  const std::vector<std::string> audit = guarded.Audit();
  const auto has = [&](const std::string& part) { EXPECT_THAT(audit, Contains(HasSubstr(part))); };
  has("identity=\"a-presenter\" role=presenter peer=\"\" act=CreateSession verdict=allowed");
  has("identity=\"\" role=none peer=\"\" act=ListStorms verdict=refused reason=\"TOKEN_UNKNOWN\"");
  has("role=viewer peer=\"\" act=CreateSession verdict=refused reason=\"ROLE_MAY_NOT\"");
  has("act=CloseSession verdict=refused reason=\"NOT_PRESENTER\"");
  has("act=UpdateScene verdict=refused reason=\"NOT_PRESENTER\"");
  has("act=CloseSession verdict=allowed");
  for (const std::string& line : audit) {
    for (const std::string& secret : {std::string("token-9"), TokenOf("presenter"),
                                      created.session_id(), created.viewer_key()}) {
      EXPECT_THAT(line, Not(HasSubstr(secret)));
    }
  }
}

// Each refusal is audited, whichever call it ends.
TEST(AccessTest, RefusalsOfAnyCallAreAudited) {
  service::ServerOptions options = Patient();
  options.limits.max_viewers_per_session = 0;
  GuardedService guarded(options);
  const auto created = guarded.Create();
  const std::string wrong_key(32, '0');
  const auto watch = [&](const std::string& key) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPatience);
    context.AddMetadata("authorization", "Bearer " + TokenOf("viewer"));
    v1::WatchFramesRequest request;
    request.set_session_id(key);
    const auto stream = guarded.stub().WatchFrames(&context, request);
    v1::WatchFramesResponse response;
    while (stream->Read(&response)) {
    }
    return stream->Finish().error_code();
  };
  EXPECT_EQ(watch(wrong_key), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(watch(created.viewer_key()), grpc::StatusCode::RESOURCE_EXHAUSTED);
  v1::ProbeRayRequest probe;
  probe.set_session_id(wrong_key);
  probe.mutable_point();
  v1::ProbeRayResponse probed;
  EXPECT_EQ(guarded.Call("viewer", &Stub::ProbeRay, probe, &probed).error_code(),
            grpc::StatusCode::NOT_FOUND);
  v1::AcknowledgeFrameRequest acknowledge;
  acknowledge.set_session_id(wrong_key);
  v1::AcknowledgeFrameResponse acknowledged;
  EXPECT_EQ(
      guarded.Call("viewer", &Stub::AcknowledgeFrame, acknowledge, &acknowledged).error_code(),
      grpc::StatusCode::NOT_FOUND);
  const std::vector<std::string> audit = guarded.Audit();
  const auto has = [&](const std::string& part) {
    EXPECT_THAT(audit, Contains(HasSubstr("role=viewer peer=\"\" act=" + part)));
  };
  has("WatchFrames verdict=refused reason=\"SESSION_NOT_FOUND\"");
  has("WatchFrames verdict=refused reason=\"TOO_MANY_VIEWERS\"");
  has("ProbeRay verdict=refused reason=\"SESSION_NOT_FOUND\"");
  has("AcknowledgeFrame verdict=refused reason=\"SESSION_NOT_FOUND\"");
}

// The pending requests of one viewer must neither fill the queue nor occupy all threads.
TEST(AccessTest, AViewerWhoAsksWithoutAPauseHoldsUpOnlyItself) {
  service::ServerOptions options = Patient();
  options.executor.max_waiting_each = 4;
  GuardedService guarded(options);
  v1::DescribeStormRequest describe;
  describe.set_storm_id("anvil");
  v1::DescribeStormResponse described;
  ASSERT_TRUE(guarded.Call("presenter", &Stub::DescribeStorm, describe, &described).ok());
  guarded.service().store->reading.Close();
  std::atomic<int> refused{0};
  std::vector<std::thread> viewers;
  const auto ask = [&] {
    v1::GetStormMapRequest request;
    request.set_storm_id("anvil");
    request.set_time_index(1);
    v1::GetStormMapResponse response;
    const grpc::Status status = guarded.Call("viewer", &Stub::GetStormMap, request, &response);
    if (status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED) ++refused;
  };
  // The requests take three of the four threads; the next four have to wait.
  for (int i = 0; i < 3; ++i) viewers.emplace_back(ask);
  EXPECT_TRUE(guarded.service().store->reading.AwaitWaiting(3));
  for (int i = 0; i < 9; ++i) viewers.emplace_back(ask);
  EXPECT_TRUE(WaitFor([&] { return refused >= 5; }));
  EXPECT_EQ(refused, 5);
  EXPECT_TRUE(guarded.Call("presenter", &Stub::DescribeStorm, describe, &described).ok())
      << "the time is in memory, and a thread is free for others";
  guarded.service().store->reading.Open();
  for (std::thread& viewer : viewers) viewer.join();
  EXPECT_THAT(guarded.Audit(), Contains(HasSubstr("identity=\"a-viewer\" role=viewer peer=\"\" "
                                                  "act=GetStormMap verdict=refused "
                                                  "reason=\"REQUEST_QUEUE_FULL\"")));
}

// An Interact call whose messages the test sends one by one.
class HandCall {
 public:
  HandCall(Stub& stub, const std::string& role) {
    if (!role.empty()) context_.AddMetadata("authorization", "Bearer " + TokenOf(role));
    context_.set_deadline(std::chrono::system_clock::now() + kPatience);
    call_ = stub.Interact(&context_);
  }
  ~HandCall() { context_.TryCancel(); }

  v1::InteractResponse Join(const std::string& key) {
    v1::InteractRequest request;
    request.mutable_join()->set_session_key(key);
    return Send(request, v1::InteractResponse::kJoined);
  }
  void Write(const v1::InteractRequest& request) { call_->Write(request); }
  // Sends the request and returns the next message of that kind, or an empty message if the call
  // ends before.
  v1::InteractResponse Send(const v1::InteractRequest& request,
                            v1::InteractResponse::MessageCase kind) {
    call_->Write(request);
    v1::InteractResponse response;
    while (call_->Read(&response)) {
      if (response.message_case() == kind) return response;
    }
    return {};
  }
  grpc::Status End() {
    v1::InteractResponse response;
    while (call_->Read(&response)) {
    }
    return call_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::InteractRequest, v1::InteractResponse>> call_;
};

TEST(AccessTest, AViewersTokenDoesNotPresentByThePresentersKey) {
  GuardedService guarded;
  const auto created = guarded.Create();
  HandCall viewer(guarded.stub(), "viewer");
  EXPECT_EQ(viewer.Join(created.session_id()).joined().role(), v1::ROLE_VIEWER);
  HandCall presenter(guarded.stub(), "presenter");
  EXPECT_EQ(presenter.Join(created.session_id()).joined().role(), v1::ROLE_PRESENTER);
  v1::InteractRequest rules;
  rules.mutable_set_rules()->mutable_rules()->set_control_locked(true);
  const auto refused = viewer.Send(rules, v1::InteractResponse::kRefused).refused();
  EXPECT_EQ(refused.status().code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(guarded.Audit(),
              Contains(HasSubstr("identity=\"a-viewer\" role=viewer peer=\"\" act=SetRules "
                                 "verdict=refused")));
}

TEST(AccessTest, WhoNeverJoinsIsCutOff) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.limits.join_timeout = std::chrono::hours(1);
  GuardedService guarded(options);
  // A joined viewer stays connected, even when later connections that do not join are cut off.
  const auto created = guarded.Create();
  HandCall joined(guarded.stub(), "presenter");
  joined.Join(created.session_id());
  HandCall silent(guarded.stub(), "viewer");
  std::future<grpc::Status> end = std::async(std::launch::async, [&] { return silent.End(); });
  // The server may learn of the call only after the time was advanced, so the test advances it
  // repeatedly.
  ASSERT_TRUE(WaitFor([&] {
    time.Advance(options.limits.join_timeout);
    return end.wait_for(milliseconds(0)) == std::future_status::ready;
  }));
  EXPECT_EQ(end.get().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  v1::InteractRequest rules;
  rules.mutable_set_rules()->mutable_rules()->set_control_locked(true);
  rules.set_request_id(7);
  EXPECT_TRUE(joined.Send(rules, v1::InteractResponse::kPresence).has_presence());
}

// The server ends the call on its own, although the client sends nothing and nothing changes.
TEST(AccessTest, ASilentViewerWithoutAValidTokenIsCutOff) {
  RunningTime time;
  GuardedService guarded(Patient(time));
  const auto created = guarded.Create();
  HandCall silent(guarded.stub(), "viewer");
  silent.Join(created.viewer_key());
  std::future<grpc::Status> end = std::async(std::launch::async, [&] { return silent.End(); });
  const auto has_ended_after = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      time.Advance(std::chrono::seconds(3));
      if (end.wait_for(milliseconds(50)) == std::future_status::ready) return true;
    }
    return false;
  };
  EXPECT_FALSE(has_ended_after(3)) << "with a valid token";
  guarded.TakeAwayToken("viewer");
  EXPECT_TRUE(WaitFor([&] { return has_ended_after(1); }));
  EXPECT_EQ(end.get().error_code(), grpc::StatusCode::UNAUTHENTICATED);
}

TEST(AccessTest, AnIdentityHasNoMoreSessionsThanItsShare) {
  service::ServerOptions options = Patient();
  options.sessions.max_sessions = 10;
  options.sessions.max_sessions_per_owner = 3;
  GuardedService guarded(options);
  v1::CreateSessionResponse first;
  for (int i = 0; i < 3; ++i) first = guarded.Create("presenter");
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SmallScene();
  v1::CreateSessionResponse response;
  const grpc::Status refused = guarded.Call("presenter", &Stub::CreateSession, request, &response);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.error_message(), HasSubstr("you already have the maximum of 3"));
  EXPECT_TRUE(RetryOf(refused).has_value());
  guarded.Create("operator");
  v1::CloseSessionRequest close;
  close.set_session_id(first.session_id());
  v1::CloseSessionResponse closed;
  ASSERT_TRUE(guarded.Call("presenter", &Stub::CloseSession, close, &closed).ok());
  guarded.Create("presenter");
}

TEST(AccessTest, RequestsAreLimited) {
  ManualTime time;
  GuardedService guarded(Patient(time), {.requests_per_second = 5.0});
  v1::ListStormsResponse storms;
  grpc::Status status;
  int taken = 0;
  while (taken < 100) {
    status = guarded.Call("viewer", &Stub::ListStorms, v1::ListStormsRequest(), &storms);
    if (!status.ok()) break;
    ++taken;
  }
  EXPECT_EQ(taken, 10) << "of two seconds";
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(RetryOf(status).has_value());
  // Another identity (token holder) has separate limits.
  EXPECT_TRUE(guarded.Call("operator", &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
  time.Advance(*RetryOf(status));
  EXPECT_TRUE(guarded.Call("viewer", &Stub::ListStorms, v1::ListStormsRequest(), &storms).ok());
}

TEST(AccessTest, MessagesOfACallAreLimited) {
  ManualTime time;
  GuardedService guarded(Patient(time), {.requests_per_second = 5.0});
  const auto created = guarded.Create();
  HandCall call(guarded.stub(), "viewer");
  call.Join(created.viewer_key());
  v1::InteractRequest request;
  request.mutable_set_name()->set_name("Anna");
  for (int i = 0; i < 30; ++i) call.Write(request);
  const auto refused = call.Send(request, v1::InteractResponse::kRefused).refused();
  EXPECT_EQ(refused.status().code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
}

TEST(AccessTest, ViewersOfASessionAreLimitedAndPresentersComeIn) {
  service::ServerOptions options = Patient();
  options.limits.max_viewers_per_session = 2;
  GuardedService guarded(options);
  const auto created = guarded.Create();
  HandCall ana(guarded.stub(), "viewer");
  HandCall ben(guarded.stub(), "viewer");
  EXPECT_TRUE(ana.Join(created.viewer_key()).has_joined());
  EXPECT_TRUE(ben.Join(created.viewer_key()).has_joined());
  HandCall third(guarded.stub(), "viewer");
  EXPECT_FALSE(third.Join(created.viewer_key()).has_joined());
  const grpc::Status refused = third.End();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(RetryOf(refused).has_value());
  HandCall presenter(guarded.stub(), "presenter");
  EXPECT_TRUE(presenter.Join(created.session_id()).has_joined());
}

// Viewers count towards the limit whichever call they use (WatchFrames or Interact), and whether or
// not they receive pictures.
TEST(AccessTest, ViewersByOldAndNewCallsAreCountedTogether) {
  service::ServerOptions options = Patient();
  options.limits.max_viewers_per_session = 2;
  GuardedService guarded(options);
  const auto created = guarded.Create();
  const auto context_of = [&] {
    auto context = std::make_unique<grpc::ClientContext>();
    context->AddMetadata("authorization", "Bearer " + TokenOf("viewer"));
    context->set_deadline(std::chrono::system_clock::now() + kPatience);
    return context;
  };
  v1::WatchFramesRequest request;
  request.set_session_id(created.viewer_key());
  v1::WatchFramesResponse response;
  const auto watching = context_of();
  const auto watch = guarded.stub().WatchFrames(watching.get(), request);
  ASSERT_TRUE(watch->Read(&response));
  HandCall ana(guarded.stub(), "viewer");
  v1::InteractRequest hidden;
  hidden.mutable_join()->set_session_key(created.viewer_key());
  hidden.mutable_join()->mutable_window()->set_hidden(true);
  EXPECT_TRUE(ana.Send(hidden, v1::InteractResponse::kJoined).has_joined());
  const auto too_many = context_of();
  EXPECT_EQ(guarded.stub().WatchFrames(too_many.get(), request)->Finish().error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  HandCall third(guarded.stub(), "viewer");
  EXPECT_FALSE(third.Join(created.viewer_key()).has_joined());
  // When a viewer leaves, another viewer may join.
  watching->TryCancel();
  watch->Finish();
  EXPECT_TRUE(WaitFor(
      [&] { return HandCall(guarded.stub(), "viewer").Join(created.viewer_key()).has_joined(); }));
}

TEST(AccessTest, PicturesAreLimitedInPixelsSamplesAndTime) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.limits.max_pixels = 64 * 36;
  options.limits.max_samples = 64 * 36 * 16;
  options.limits.max_render_time = std::chrono::hours(1);
  GuardedService guarded(options);
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  v1::RenderImageResponse response;
  const auto render = [&] {
    return guarded.Call("pipeline", &Stub::RenderImage, request, &response);
  };
  EXPECT_TRUE(render().ok());
  // Time spent waiting for another picture does not count against the limit.
  FakeMachine& machine = *guarded.service().machine;
  machine.drawing.Close();
  std::thread first([&] {
    v1::RenderImageResponse drawn;
    EXPECT_TRUE(guarded.Call("operator", &Stub::RenderImage, request, &drawn).ok());
  });
  EXPECT_TRUE(machine.drawing.AwaitWaiting(1));
  grpc::Status status;
  std::thread second([&] { status = render(); });
  EXPECT_TRUE(WaitFor([&] { return guarded.service().server().Load().pictures == 2; }));
  time.Advance(2 * options.limits.max_render_time);
  machine.drawing.Open();
  first.join();
  second.join();
  EXPECT_TRUE(status.ok()) << status.error_message();
  // The picture is drawn in several pieces, of which the first takes too long.
  machine.ms_per_mega_sample = 1'000.0;
  machine.drawing.Close();
  std::thread slow([&] { status = render(); });
  EXPECT_TRUE(machine.drawing.AwaitWaiting(1));
  time.Advance(2 * options.limits.max_render_time);
  machine.drawing.Open();
  slow.join();
  machine.ms_per_mega_sample = 0.0;
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("not ready after the 3600000 ms"));
  request.mutable_scene()->mutable_rendering()->mutable_light_volume()->set_slices(17);
  status = render();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("39168 samples; this server allows 36864"));
  EXPECT_TRUE(RetryOf(status).has_value());
  *request.mutable_scene() = SmallScene();
  request.mutable_scene()->mutable_output()->set_width_px(65);
  EXPECT_THAT(render().error_message(), HasSubstr("2340 pixels; this server allows 2304"));
  // The limit also applies to a session's pictures.
  v1::CreateSessionRequest create;
  *create.mutable_scene() = request.scene();
  v1::CreateSessionResponse created;
  EXPECT_EQ(guarded.Call("presenter", &Stub::CreateSession, create, &created).error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
}

// Allows each client one request a second. Clients are told apart by the address that a trusted
// proxy names, or otherwise by their own address.
TEST(AccessTest, BehindATrustedProxyEachClientHasAShareOfItsOwn) {
  for (const bool trusted : {true, false}) {
    SCOPED_TRACE(trusted);
    std::mutex mutex;
    std::vector<std::string> lines;
    ManualTime time;
    service::ServerOptions options = Patient(time);
    options.address = "127.0.0.1:0";
    options.access_control = std::make_shared<access::AccessControl>(
        access::TrustEverybody(), std::make_shared<access::Audit>([&](const std::string& line) {
          const std::lock_guard lock(mutex);
          lines.push_back(line);
        }),
        access::QuotaLimits{.requests_per_second = 1.0},
        trusted ? *base::TrustedProxies::Parse({"127.0.0.0/8"}) : base::TrustedProxies(), time);
    FakeService service(options);
    const auto stub = v1::ThunderheadService::NewStub(grpc::CreateChannel(
        absl::StrCat("127.0.0.1:", service.server().Port()), grpc::InsecureChannelCredentials()));
    const auto ask = [&](const std::string& forwarded_for) {
      v1::ListStormsRequest request;
      v1::ListStormsResponse response;
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + kPatience);
      context.AddMetadata("x-forwarded-for", forwarded_for);
      return stub->ListStorms(&context, request, &response).error_code();
    };
    // The client's own entry comes before the one that the proxy adds.
    bool refused = false;
    for (int i = 0; i < 100 && !refused; ++i) {
      refused = ask(absl::StrCat("203.0.113.", i, ", 192.0.2.7")) != grpc::StatusCode::OK;
    }
    EXPECT_TRUE(refused);
    if (trusted) {
      EXPECT_EQ(ask("192.0.2.8"), grpc::StatusCode::OK);
    }
    const std::lock_guard lock(mutex);
    ASSERT_FALSE(lines.empty());
    EXPECT_THAT(lines.front(), HasSubstr(trusted ? "192.0.2.7:0" : "127.0.0.1:"));
  }
}

TEST(AccessTest, ATokenThatIsTakenAwayEndsStreamsAndTheAuditSaysSo) {
  RunningTime time;
  GuardedService guarded(Patient(time));
  const v1::CreateSessionResponse session = guarded.Create();
  const auto viewer = [] {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + 2 * kPatience);
    context->AddMetadata("authorization", "Bearer " + TokenOf("viewer"));
    return context;
  };
  const auto interacting = viewer();
  const auto interact = guarded.stub().Interact(interacting.get());
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(session.viewer_key());
  ASSERT_TRUE(interact->Write(join));
  v1::InteractResponse joined;
  ASSERT_TRUE(interact->Read(&joined));
  v1::WatchFramesRequest watch;
  watch.set_session_id(session.viewer_key());
  const auto watching = viewer();
  const auto frames = guarded.stub().WatchFrames(watching.get(), watch);
  v1::WatchFramesResponse event;
  ASSERT_TRUE(frames->Read(&event));
  guarded.TakeAwayToken("viewer");
  // The server checks tokens once a second.
  time.Advance(std::chrono::seconds(2));

  // The server sends frames only while the scene changes and the viewer acknowledges them.
  v1::UpdateSceneRequest update;
  update.set_session_id(session.session_id());
  *update.mutable_scene() = SmallScene();
  do {
    v1::AcknowledgeFrameRequest taken;
    taken.set_session_id(session.session_id());
    taken.set_viewer_id(event.viewer_id());
    taken.set_sequence(event.frame().sequence());
    v1::AcknowledgeFrameResponse acknowledged;
    guarded.Call("presenter", &Stub::AcknowledgeFrame, taken, &acknowledged);
    v1::Sun& sun = *update.mutable_scene()->mutable_sun();
    sun.set_azimuth_deg(sun.azimuth_deg() + 1.0F);
    v1::UpdateSceneResponse updated;
    guarded.Call("presenter", &Stub::UpdateScene, update, &updated);
  } while (frames->Read(&event));
  EXPECT_EQ(frames->Finish().error_code(), grpc::StatusCode::UNAUTHENTICATED);

  v1::InteractRequest alive;
  alive.mutable_alive();
  EXPECT_TRUE(WaitFor([&] { return !interact->Write(alive); }));
  while (interact->Read(&joined)) {
  }
  EXPECT_EQ(interact->Finish().error_code(), grpc::StatusCode::UNAUTHENTICATED);
  for (const char* call : {"act=Interact ", "act=WatchFrames "}) {
    EXPECT_THAT(guarded.Audit(), Contains(AllOf(HasSubstr(call), HasSubstr("identity=\"a-viewer\""),
                                                HasSubstr("reason=\"TOKEN_UNKNOWN\""))));
  }
}

// Reflection needs no token.
TEST(AccessTest, AFloodOfReflectionTakesNoThreadsAndOthersGoOn) {
  GuardedService guarded;
  const auto threads = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const auto before = threads();
  constexpr std::intptr_t kCalls = 300;
  grpc::GenericStub stub(guarded.service().server().LocalChannel());
  grpc::CompletionQueue queue;
  std::vector<grpc::ClientContext> contexts(kCalls);
  std::vector<grpc::Status> ends(kCalls);
  std::vector<std::unique_ptr<grpc::GenericClientAsyncReaderWriter>> calls;
  const auto await = [&queue](milliseconds patience) {
    void* tag = nullptr;
    bool ok = false;
    return queue.AsyncNext(&tag, &ok, std::chrono::system_clock::now() + patience) ==
           grpc::CompletionQueue::GOT_EVENT;
  };
  for (std::size_t i = 0; i < kCalls; ++i) {
    calls.push_back(stub.PrepareCall(
        &contexts[i], "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue));
    calls.back()->StartCall(nullptr);
    ASSERT_TRUE(await(kPatience));
    calls.back()->Finish(&ends[i], nullptr);
  }
  int refused = 0;
  // As many calls as may be open at once stay open.
  while (refused < kCalls - 16 && await(kPatience)) ++refused;
  EXPECT_GE(refused, kCalls - 16);
  EXPECT_LT(threads(), before + 16) << "an open call occupies no thread";
  EXPECT_EQ(guarded.Ask("ListStorms", TokenOf("viewer")), grpc::StatusCode::OK);
  for (grpc::ClientContext& context : contexts) context.TryCancel();
  for (; refused < kCalls; ++refused) ASSERT_TRUE(await(kPatience));
  const auto is_refused = [](const grpc::Status& status) {
    return status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
  };
  EXPECT_GE(std::ranges::count_if(ends, is_refused), kCalls - 16);
}

TEST(AccessTest, HealthNeedsNoTokenAndNoCallThatStaysOpen) {
  GuardedService guarded;
  const auto ask = [&](const std::string& method) {
    return guarded.Ask(method, "", "grpc.health.v1.Health");
  };
  EXPECT_EQ(ask("Check"), grpc::StatusCode::OK);
  EXPECT_EQ(ask("Watch"), grpc::StatusCode::UNIMPLEMENTED);
}

// Opens calls until one is refused, then closes them.
TEST(AccessTest, AFloodOfStreamsIsRefusedAndOthersGoOn) {
  GuardedService guarded(Patient(), {.max_streams_per_identity = 100, .requests_per_second = 0});
  const auto created = guarded.Create();
  std::vector<std::unique_ptr<HandCall>> calls;
  for (int i = 0; i < 100; ++i) {
    calls.push_back(std::make_unique<HandCall>(guarded.stub(), "viewer"));
    ASSERT_TRUE(calls.back()->Join(created.viewer_key()).has_joined()) << i;
  }
  for (int i = 0; i < 2000; ++i) {
    HandCall call(guarded.stub(), "viewer");
    const grpc::Status status = call.End();
    ASSERT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << i;
    ASSERT_TRUE(RetryOf(status).has_value());
  }
  HandCall presenter(guarded.stub(), "presenter");
  EXPECT_TRUE(presenter.Join(created.session_id()).has_joined());
  calls.clear();
  // The server notices a little later that the calls have ended.
  EXPECT_TRUE(WaitFor(
      [&] { return HandCall(guarded.stub(), "viewer").Join(created.viewer_key()).has_joined(); }));
}

}  // namespace
}  // namespace thunderhead::testing
