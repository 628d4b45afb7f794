// Tests of counters, of the text that Prometheus reads, and of the operator's port.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "boost/asio/io_context.hpp"
#include "boost/asio/ip/tcp.hpp"
#include "boost/asio/read.hpp"
#include "boost/asio/write.hpp"
#include "telemetry/exposition.h"
#include "telemetry/metrics.h"
#include "telemetry/operator_port.h"
#include "tests/support/own_host.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::telemetry {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Histogram, CountsInBucketsThatDouble) {
  Histogram histogram;
  histogram.Observe(0.001);
  histogram.Observe(0.0011);
  histogram.Observe(1000.0);
  EXPECT_EQ(histogram.Count(0), 1U);
  EXPECT_EQ(histogram.Count(1), 1U);
  EXPECT_EQ(histogram.Count(Histogram::kBounds), 1U);
  EXPECT_DOUBLE_EQ(Histogram::BoundOf(10), 1.024);
  EXPECT_NEAR(histogram.Sum(), 1000.0021, 1e-6);
}

TEST(Counter, CountsFromManyThreads) {
  Counter counter;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int n = 0; n < 10'000; ++n) counter.Add();
    });
  }
  threads.clear();
  EXPECT_EQ(counter.Value(), 40'000U);
}

TEST(Exposition, HasWhatAlertsWaitForFromTheStart) {
  const std::string text = Expose(Metrics(), {});
  for (const char* line :
       {"thunderhead_job_pictures_total{outcome=\"failed\"} 0\n",
        "thunderhead_job_pictures_total{outcome=\"drawn\"} 0\n",
        "thunderhead_reader_failures_total{reason=\"crashed\"} 0\n",
        "thunderhead_session_save_failures_total 0\n", "thunderhead_session_damages_total 0\n",
        "thunderhead_device_losses_total 0\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(Exposition, IsPrometheusText) {
  Metrics metrics;
  metrics.frames.Of("light_volume").Add(3);
  metrics.update_to_frame.Observe(0.0015);
  metrics.update_to_frame.Observe(0.1);
  metrics.refusals.Of("TOO_MANY \"quotes\"\n").Add();
  const std::string text = Expose(metrics, {{"thunderhead_sessions", "Sessions", 2.0}});
  EXPECT_THAT(text, HasSubstr("thunderhead_frames_total{technique=\"light_volume\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE thunderhead_update_to_frame_seconds histogram\n"));
  EXPECT_THAT(text, HasSubstr("thunderhead_update_to_frame_seconds_bucket{le=\"0.001\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("thunderhead_update_to_frame_seconds_bucket{le=\"0.002\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("thunderhead_update_to_frame_seconds_bucket{le=\"+Inf\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("thunderhead_update_to_frame_seconds_count 2\n"));
  EXPECT_THAT(text,
              HasSubstr("thunderhead_refusals_total{reason=\"TOO_MANY \\\"quotes\\\"\\n\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("thunderhead_sessions 2\n"));
}

TEST(ResidentBytes, IsAboutThisProcess) {
  EXPECT_GT(ResidentBytes(), 1e6);
  EXPECT_LT(ResidentBytes(), 1e11);
}

class Port : public ::testing::Test {
 protected:
  Port() { Open(testing::kHangLimit); }

  void Open(std::chrono::milliseconds patience,
            std::function<bool(std::string_view host)> allows_host = {}) {
    auto port = OperatorPort::Open("127.0.0.1", 0,
                                   {.metrics = [this] { return Expose(metrics_, {}); },
                                    .health = [this] { return health_; },
                                    .allows_host = std::move(allows_host)},
                                   patience);
    EXPECT_TRUE(port.ok()) << port.status();
    port_ = *std::move(port);
  }

  boost::asio::ip::tcp::socket Connect() {
    boost::asio::ip::tcp::socket socket(io_);
    socket.connect({boost::asio::ip::make_address("127.0.0.1"), port_->Port()});
    return socket;
  }

  std::string Get(const std::string& path, const std::string& host = "here") {
    auto socket = Connect();
    boost::asio::write(
        socket, boost::asio::buffer("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n"));
    std::string answer;
    boost::system::error_code error;
    boost::asio::read(socket, boost::asio::dynamic_buffer(answer), error);
    return answer;
  }

  Metrics metrics_;
  Health health_;
  boost::asio::io_context io_;
  std::unique_ptr<OperatorPort> port_;
};

TEST_F(Port, AnswersHealth) {
  health_ = {.alive = true, .ready = true, .state = "serving"};
  EXPECT_THAT(Get("/healthz"), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("serving")));
  EXPECT_THAT(Get("/readyz"), StartsWith("HTTP/1.1 200"));
  health_ = {.alive = true, .ready = false, .state = "draining"};
  EXPECT_THAT(Get("/healthz"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Get("/readyz"), AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("draining")));
  health_ = {.alive = false, .ready = false, .state = "not making progress"};
  EXPECT_THAT(Get("/healthz"), StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(Get("/else"), StartsWith("HTTP/1.1 404"));
}

TEST_F(Port, ASlowClientHoldsUpNobody) {
  auto silent = Connect();
  boost::asio::write(silent, boost::asio::buffer(std::string("GET /met")));
  EXPECT_THAT(Get("/healthz"), StartsWith("HTTP/1.1 200"));
}

TEST_F(Port, ASlowClientIsCutOff) {
  Open(std::chrono::milliseconds(10));
  auto silent = Connect();
  boost::system::error_code error;
  boost::asio::write(silent, boost::asio::buffer(std::string("GET /met")), error);
  char byte = 0;
  EXPECT_EQ(boost::asio::read(silent, boost::asio::buffer(&byte, 1), error), 0U);
  EXPECT_TRUE(error);
}

TEST_F(Port, SilentClientsHoldUpNobody) {
  // The test connects more clients than the port allows.
  std::vector<boost::asio::ip::tcp::socket> silent;
  for (int i = 0; i < 100; ++i) silent.push_back(Connect());
  EXPECT_THAT(Get("/healthz"), StartsWith("HTTP/1.1 200"));
  // The oldest client was disconnected; the newest is still connected.
  boost::system::error_code error;
  char byte = 0;
  boost::asio::read(silent.front(), boost::asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  silent.back().non_blocking(true);
  silent.back().read_some(boost::asio::buffer(&byte, 1), error);
  EXPECT_EQ(error, boost::asio::error::would_block);
}

TEST_F(Port, AnswersToItsNamesAlone) {
  Open(testing::kHangLimit, [](std::string_view host) { return host == "here"; });
  EXPECT_THAT(Get("/metrics"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Get("/metrics", "evil.example"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(Get("/readyz", "evil.example"), StartsWith("HTTP/1.1 403"));
}

TEST_F(Port, TheSamePortTwiceIsAnError) {
  const auto second = OperatorPort::Open("127.0.0.1", port_->Port(), {});
  EXPECT_EQ(second.status().code(), absl::StatusCode::kUnavailable);
}

// Debian's Prometheus scrapes the port, and finds the values with its own query language.
TEST_F(Port, IsScrapedByPrometheus) {
  if (std::system("command -v prometheus promtool > /dev/null") != 0) {
    GTEST_SKIP() << "needs Debian's package prometheus (deploy/packages/test.txt)";
  }
  metrics_.frames.Of("light_volume").Add(42);
  metrics_.update_to_frame.Observe(0.02);
  testing::TemporaryFolder folder;
  const std::string config = folder.File("prometheus.yml");
  std::ofstream(config) << "scrape_configs:\n- job_name: thunderhead\n  scrape_interval: 1s\n"
                        << "  static_configs:\n  - targets: ['127.0.0.1:" << port_->Port()
                        << "']\n";
  const auto free_port = [this] {
    boost::asio::ip::tcp::acceptor acceptor(io_,
                                            {boost::asio::ip::make_address(testing::OwnHost()), 0});
    return acceptor.local_endpoint().port();
  }();
  const std::string address = testing::OwnHost() + ":" + std::to_string(free_port);
  const std::string pid_file = folder.File("pid");
  ASSERT_EQ(std::system(("prometheus --config.file=" + config + " --storage.tsdb.path=" +
                         folder.File("tsdb") + " --web.listen-address=" + address + " > " +
                         folder.File("log") + " 2>&1 & echo $! > " + pid_file)
                            .c_str()),
            0);
  const auto query = [&](const std::string& expression) {
    const std::string out = folder.File("out");
    std::system(
        ("promtool query instant http://" + address + " '" + expression + "' > " + out + " 2>&1")
            .c_str());
    std::ostringstream text;
    text << std::ifstream(out).rdbuf();
    return text.str();
  };
  std::string frames;
  EXPECT_TRUE(testing::WaitFor([&] {
    frames = query("thunderhead_frames_total{technique=\"light_volume\"}");
    return frames.find("=> 42") != std::string::npos;
  })) << frames;
  EXPECT_THAT(query("thunderhead_update_to_frame_seconds_count"), HasSubstr("=> 1"));
  std::system(("kill $(cat " + pid_file + ")").c_str());
}

}  // namespace
}  // namespace thunderhead::telemetry
