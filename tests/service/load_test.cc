// Tests of the load generator, by gRPC and by WebSocket. The server uses fakes.
#include "load/load.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "base/whole_file.h"
#include "gateway/gateway.h"
#include "gateway/tls_contexts.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/figure.h"
#include "tests/support/self_signed.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::load {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::Ge;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::Lt;
using ::testing::Not;
using ::testing::Pair;

enum class By { kGrpc, kWebSocket };

// A load that lasts until a test stops it.
constexpr double kForEver_s = 1e6;

// Times with which no test fails on a slow machine.
constexpr LoadTimes kTimes{.warm_up_s = 0.1,
                           .sampling_s = 0.05,
                           .visit_s = 0.5,
                           .join_patience_s = 600.0,
                           .leave_patience_s = 600.0,
                           .call_patience_s = 600.0};

service::ServerOptions OnFreePort() {
  service::ServerOptions options = testing::Patient();
  options.address = "127.0.0.1:0";
  return options;
}

class LoadTest : public ::testing::TestWithParam<By> {
 protected:
  LoadTest() {
    auto gateway = gateway::Gateway::Start({}, service_->server().LocalChannel());
    EXPECT_TRUE(gateway.ok()) << gateway.status();
    gateway_ = *std::move(gateway);
    options_.viewers = 3;
    options_.seconds = kForEver_s;
    options_.width_px = 64;
    options_.height_px = 36;
    options_.steer_hz = 50.0;
    options_.times = kTimes;
  }

  int Port() const {
    return GetParam() == By::kGrpc ? service_->server().Port() : gateway_->Port();
  }

  std::unique_ptr<Transport> MakeTransport() const {
    return GetParam() == By::kGrpc ? MakeGrpcTransport("127.0.0.1:" + std::to_string(Port()))
                                   : MakeWebSocketTransport("127.0.0.1", Port());
  }

  absl::StatusOr<Report> Run(
      const std::function<void(const Progress&)>& progress = [](auto&) {},
      const std::stop_token& stop = {}) {
    const auto transport = MakeTransport();
    return load::Run(options_, *transport, ServerProcess::Find("127.0.0.1", Port()), stop,
                     progress);
  }

  // Runs until each viewer that reads all its messages has received at least `frames` frames.
  absl::StatusOr<Report> RunFor(std::uint64_t frames) {
    return RunUntil([frames](const Progress& progress) { return progress.least_frames >= frames; });
  }

  absl::StatusOr<Report> RunUntil(const std::function<bool(const Progress&)>& enough) {
    std::stop_source stop;
    return Run(
        [&](const Progress& progress) {
          if (enough(progress)) stop.request_stop();
        },
        stop.get_token());
  }

  // Returns the maximum data rate in kbit/s of throttled viewers. It includes the message that was
  // in flight when the measured period began.
  double MostKbit(const Report& report) const {
    return 1.5 * options_.kbit_per_s +
           2.0 * 8e-3 * report.throttled.bytes_per_frame / report.seconds;
  }

  void StopServer() {
    gateway_.reset();
    service_.reset();
  }

  LoadOptions options_;
  std::unique_ptr<testing::FakeService> service_ =
      std::make_unique<testing::FakeService>(OnFreePort());
  std::unique_ptr<gateway::Gateway> gateway_;
};

TEST_P(LoadTest, HasAllFigures) {
  const auto report = RunFor(10);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->healthy.viewers, 3);
  EXPECT_THAT(report->healthy.fps_min, Gt(0.0));
  EXPECT_THAT(report->healthy.fps_median, Ge(report->healthy.fps_min));
  ASSERT_TRUE(report->healthy.latency_ms.has_value());
  EXPECT_THAT(report->healthy.latency_ms->p50, Gt(0.0));
  EXPECT_THAT(report->healthy.latency_ms->p95, Ge(report->healthy.latency_ms->p50));
  EXPECT_THAT(report->healthy.latency_ms->p99, Ge(report->healthy.latency_ms->p95));
  EXPECT_THAT(report->healthy.kbit_per_viewer, Gt(0.0));
  EXPECT_THAT(report->healthy.bytes_per_frame, Gt(100.0));
  EXPECT_EQ(report->healthy_first.count, 3);
  // The server runs in this process, so its memory use can be measured.
  ASSERT_TRUE(report->server.has_value());
  EXPECT_THAT(report->server->rss_first_mb, Gt(1.0));
  EXPECT_THAT(report->server->rss_last_mb, Gt(1.0));
  EXPECT_THAT(report->server->rss_most_mb, Ge(report->server->rss_last_mb));
  for (const char* key :
       {"viewers", "fps_min", "fps_median", "latency_ms", "spread_ms", "p50", "p95", "p99",
        "kbit_per_viewer", "errors", "server_rss_mb", "first", "last", "most"}) {
    EXPECT_THAT(ToJson(*report), HasSubstr("\"" + std::string(key) + "\": "));
  }
  EXPECT_THAT(ToJson(*report), Not(HasSubstr("null, \"p95\"")));
}

TEST_P(LoadTest, AClassSeesTheSamePicture) {
  options_.viewers = 30;
  const auto report = RunFor(5);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->healthy.viewers, 30);
  EXPECT_TRUE(report->healthy.spread_ms.has_value()) << ToText(*report);
}

TEST_P(LoadTest, LeavesNoSessionBehind) {
  options_.viewers = 1;
  options_.seconds = 0.2;
  service::ServerOptions options = OnFreePort();
  options.sessions.max_sessions = 1;
  gateway_.reset();
  service_ = std::make_unique<testing::FakeService>(options);
  auto gateway = gateway::Gateway::Start({}, service_->server().LocalChannel());
  ASSERT_TRUE(gateway.ok()) << gateway.status();
  gateway_ = *std::move(gateway);
  for (int i = 0; i < 2; ++i) {
    const auto report = Run();
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  }
}

TEST_P(LoadTest, StalledAndThrottledViewersDoNotSlowOthers) {
  options_.stalled = 2;
  options_.throttled = 1;
  options_.kbit_per_s = 16.0;
  const auto report = RunFor(20);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->healthy.viewers, 3);
  EXPECT_EQ(report->stalled, 2);
  EXPECT_EQ(report->throttled.viewers, 1);
  EXPECT_THAT(report->throttled.kbit_per_viewer, Le(MostKbit(*report))) << ToText(*report);
}

TEST_P(LoadTest, WhoLooksAroundGetsPicturesOfTheOwnViewAndTheOthersTheSessions) {
  options_.looking = 2;
  // Two frames may be unacknowledged, so five frames prove that frames are acknowledged.
  const auto report = RunFor(5);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->healthy.viewers, 1);
  EXPECT_EQ(report->looking.viewers, 2);
  EXPECT_THAT(report->looking.fps_min, Gt(2.0 / report->seconds)) << ToText(*report);
  EXPECT_THAT(report->healthy.fps_min, Gt(2.0 / report->seconds)) << ToText(*report);
  EXPECT_EQ(report->looking_first.count, 2U);
  EXPECT_FALSE(report->looking.latency_ms.has_value());
  EXPECT_THAT(ToText(*report), HasSubstr("looking around: 2\n"));
  EXPECT_THAT(ToJson(*report), HasSubstr("\"looking\": {\"viewers\": 2, "));
}

TEST_P(LoadTest, ARateWithoutANumberThrottlesAllViewers) {
  Throttle(16.0, std::nullopt, options_);
  double shown_fps = 0.0;
  const auto report = RunUntil([&](const Progress& progress) {
    shown_fps = std::max(shown_fps, progress.frames_per_s);
    return progress.least_frames >= 2;
  });
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->healthy.viewers, 0);
  EXPECT_EQ(report->throttled.viewers, 3);
  EXPECT_THAT(report->throttled.kbit_per_viewer, AllOf(Gt(0.0), Le(MostKbit(*report))))
      << ToText(*report);
  EXPECT_EQ(report->throttled_first.count, 3U);
  EXPECT_THAT(shown_fps, Gt(0.0));
  EXPECT_TRUE(std::isfinite(shown_fps));
}

TEST_P(LoadTest, WithPassingViewersAloneTheShownRateIs0) {
  options_.viewers = 0;
  options_.passing = 1;
  std::vector<double> shown_fps;
  const auto report = RunUntil([&](const Progress& progress) {
    shown_fps.push_back(progress.frames_per_s);
    return progress.joined > 0;
  });
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_THAT(shown_fps, Each(0.0));
}

TEST_P(LoadTest, PassingViewersComeAndGetAFrameEachTime) {
  options_.passing = 40;
  const auto report = RunUntil([](const Progress& progress) { return progress.visits >= 60; });
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_EQ(report->passing, 40);
  // A passing viewer without a frame is an error.
  EXPECT_THAT(report->passing_first.count, Ge(60U)) << ToText(*report);
}

TEST_P(LoadTest, CountsTheErrorsOfAServerThatStops) {
  std::jthread stopping;
  const auto report = Run([&](const Progress& progress) {
    if (progress.least_frames > 0 && !stopping.joinable())
      stopping = std::jthread([&] { StopServer(); });
  });
  ASSERT_TRUE(report.ok()) << report.status();
  // The load generator does not wait until its duration is over, and reports the figures so far.
  EXPECT_THAT(report->seconds, Lt(kForEver_s));
  EXPECT_THAT(report->healthy.fps_min, Gt(0.0));
  // Three viewers and the presenter fail, and so does closing the session.
  EXPECT_THAT(report->ErrorCount(), Ge(4)) << ToText(*report);
  EXPECT_THAT(report->errors, Contains(Pair(HasSubstr("UNAVAILABLE"), Ge(3)))) << ToText(*report);
}

TEST_P(LoadTest, InterruptedHasTheFiguresSoFar) {
  const auto report = RunFor(1);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_THAT(report->seconds, Lt(kForEver_s));
  EXPECT_THAT(report->healthy.fps_min, Gt(0.0));
}

TEST_P(LoadTest, InterruptedWaitsForNoImage) {
  // The picture takes hours, a frame some milliseconds.
  service_->machine->ms_per_mega_sample = 100.0;
  options_.images = {.count = 1, .width_px = 4096, .height_px = 2048, .slices = 4096};
  const auto report = RunFor(1);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
  EXPECT_THAT(ToText(*report), HasSubstr("images: 1 asked for at once, 0 came"));
}

TEST_P(LoadTest, FailsWithoutAServer) {
  const auto transport = MakeTransport();
  StopServer();
  const auto report = load::Run(options_, *transport, std::nullopt, {}, [](auto&) {});
  EXPECT_EQ(report.status().code(), absl::StatusCode::kUnavailable) << report.status();
}

// A listener that waits for the end of a call.
class EndListener final : public Listener {
 public:
  void OnMessage(google::protobuf::io::ZeroCopyInputStream& /*message*/,
                 std::size_t /*bytes*/) override {}
  void OnEnd(const absl::Status& status) override { end_.set_value(status); }
  absl::Status Await() {
    auto end = end_.get_future();
    if (end.wait_for(testing::kPatience) != std::future_status::ready) {
      return absl::DeadlineExceededError("the call did not end");
    }
    return end.get();
  }

 private:
  std::promise<absl::Status> end_;
};

TEST_P(LoadTest, AcknowledgingAfterLeavingIsNoError) {
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(service_->Open(testing::SmallScene()));
  v1::InteractRequest acknowledge;
  acknowledge.mutable_acknowledge()->set_sequence(1);
  const auto transport = MakeTransport();
  EndListener listener;
  const auto link = transport->Interact(listener, {});
  link->Send(join.SerializeAsString());
  link->HalfClose();
  link->Send(acknowledge.SerializeAsString());
  const absl::Status end = listener.Await();
  EXPECT_TRUE(end.ok()) << end;
}

// Measures how well a server on fakes serves a class, which depends on the machine.
class LoadBenchmark : public LoadTest {};

TEST_P(LoadBenchmark, AClassAndSlowViewers) {
  options_.viewers = 30;
  options_.stalled = 2;
  options_.throttled = 1;
  options_.kbit_per_s = 16.0;
  options_.seconds = 5.0;
  options_.times = {};
  const auto report = Run();
  ASSERT_TRUE(report.ok()) << report.status();
  testing::Figure("frames of a healthy viewer, least", report->healthy.fps_min, "1/s");
  testing::Figure("frames of a throttled viewer, median", report->throttled.fps_median, "1/s");
  if (report->healthy.spread_ms.has_value()) {
    testing::Figure("from the first viewer who shows a picture to the last, 99th percentile",
                    report->healthy.spread_ms->p99, "ms");
  }
}

INSTANTIATE_TEST_SUITE_P(Transports, LoadBenchmark, ::testing::Values(By::kGrpc, By::kWebSocket),
                         [](const auto& by) {
                           return by.param == By::kGrpc ? "Grpc" : "WebSocket";
                         });

INSTANTIATE_TEST_SUITE_P(Transports, LoadTest, ::testing::Values(By::kGrpc, By::kWebSocket),
                         [](const auto& by) {
                           return by.param == By::kGrpc ? "Grpc" : "WebSocket";
                         });

TEST(SecureLoad, ComesByTlsToWhomItTrustsOnly) {
  const testing::TemporaryFolder folder;
  const std::string certificate = folder.File("certificate.pem");
  testing::WriteSelfSigned(certificate, folder.File("key.pem"), 1);
  testing::FakeService service;
  gateway::GatewayOptions site;
  site.address = "0.0.0.0";  // an address that the certificate does not name
  site.tls = gateway::TlsContexts::Open({certificate, folder.File("key.pem")}).value();
  const auto gateway = gateway::Gateway::Start(site, service.server().LocalChannel());
  ASSERT_TRUE(gateway.ok()) << gateway.status();
  const int port = (*gateway)->Port();
  LoadOptions options;
  options.viewers = 2;
  options.seconds = kForEver_s;
  options.times = kTimes;
  options.width_px = 64;
  options.height_px = 36;
  const auto run = [&](const std::string& host, const std::string& roots) {
    const auto transport = MakeSecureWebSocketTransport(host, port, {.tls_roots = roots});
    if (!transport.ok()) return absl::StatusOr<Report>(transport.status());
    std::stop_source stop;
    return load::Run(options, **transport, std::nullopt, stop.get_token(),
                     [&](const Progress& progress) {
                       if (progress.least_frames >= 2) stop.request_stop();
                     });
  };
  const std::string roots = *base::ReadWholeFile(certificate);
  for (const std::string host : {"127.0.0.1", "localhost"}) {
    const auto report = run(host, roots);
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_EQ(report->ErrorCount(), 0) << ToText(*report);
    EXPECT_THAT(report->healthy.fps_min, Gt(0.0));
  }
  // The machine does not trust the certificate, and the certificate is not for the requested name.
  const auto stranger = run("127.0.0.1", "");
  EXPECT_EQ(stranger.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(stranger.status().message()), HasSubstr("speak TLS with https://"));
  const auto another = run("127.0.0.2", roots);
  EXPECT_EQ(another.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(another.status().message()), HasSubstr("speak TLS with https://"));
  EXPECT_EQ(run("127.0.0.1", "no PEM").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(ServerProcess, IsFoundByItsPort) {
  testing::FakeService service(OnFreePort());
  const auto process = ServerProcess::Find("127.0.0.1", service.server().Port());
  ASSERT_TRUE(process.has_value());
  EXPECT_EQ(process->pid(), ::getpid());
  const auto sample = process->Sample();
  ASSERT_TRUE(sample.has_value());
  EXPECT_THAT(sample->rss_mb, Gt(1.0));
  // The address belongs to no machine; it is reserved for documentation.
  EXPECT_FALSE(ServerProcess::Find("192.0.2.1", service.server().Port()).has_value());
}

}  // namespace
}  // namespace thunderhead::load
