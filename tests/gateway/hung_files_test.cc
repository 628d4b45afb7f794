// Tests of files whose storage does not answer. The gateway opens its files by a function that
// waits at the path of a named pipe until the pipe has a writer.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "base/file_descriptor.h"
#include "base/own_file.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/websocket_client.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

namespace http = boost::beast::http;
using ::testing::HasSubstr;

class HungFilesTest : public EchoTest {
 protected:
  HungFilesTest() {
    std::ofstream(folder_.File("index.html")) << "<html>storm</html>";
    std::ofstream(folder_.File("result.png")) << "picture";
    options_.page_directory = folder_.Path().string();
    EXPECT_EQ(mkfifo(hung_.c_str(), 0600), 0);
    options_.open_file = [hung = hung_](const std::string& path) {
      if (path == hung) base::FileDescriptor(open(path.c_str(), O_RDONLY));
      return base::OpenOwnFile(path);
    };
    options_.find_kept_file = [this](std::string_view path) -> std::optional<KeptFile> {
      if (path == "/results/hung/0") {
        ++asked_;
        return KeptFile{hung_, "hung"};
      }
      if (path == "/results/fine/0") return KeptFile{folder_.File("result.png"), "fine"};
      return std::nullopt;
    };
  }
  ~HungFilesTest() override {
    // The storage answers again: the calls that wait in the kernel continue.
    const int storage = open(hung_.c_str(), O_RDWR | O_NONBLOCK);
    site_.reset();
    close(storage);
  }

  // Lets `count` clients request the hung file, and waits until the gateway has their requests.
  std::vector<std::unique_ptr<RawClient>> AskHung(int count) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (int i = 0; i < count; ++i) {
      clients.push_back(std::make_unique<RawClient>(Site().Port()));
      clients.back()->Send("GET /results/hung/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    }
    EXPECT_TRUE(testing::WaitFor([&] { return asked_ == count; }));
    return clients;
  }
  Response Ask(const std::string& target) { return RawClient(Site().Port()).Ask("GET", target); }

  testing::TemporaryFolder folder_;
  const std::string hung_ = folder_.File("hung.png");
  std::atomic<int> asked_{0};
};

TEST_F(HungFilesTest, OnlyWhoWantsThemWaits) {
  DriveTime();
  WebSocketClient viewer(Site().Port());
  const std::string message("\0\x0a\x05storm", 8);
  const auto hung = AskHung(4);
  viewer.Send(message);
  EXPECT_TRUE(viewer.Receive().has_value());
  EXPECT_EQ(Ask("/").body(), "<html>storm</html>");
  EXPECT_EQ(Call(Site().Port(), "Say", "").Trailer("grpc-status"), "0");
  // As many requests hang as there are threads. Another result still arrives once they have hung
  // for a while.
  RawClient fine(Site().Port());
  fine.Send("GET /results/fine/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(WaitWhileTimePasses([&] { return fine.HasInput(); }));
  EXPECT_EQ(fine.Read().body(), "picture");
  for (const auto& client : hung) EXPECT_FALSE(client->HasInput());
  viewer.Vanish();
}

TEST_F(HungFilesTest, WhoWantsThemIsToldToTryAgain) {
  DriveTime();
  options_.file_timeout = std::chrono::seconds(10);
  const auto begin = time_.Now();
  // There are more requests than threads that read files.
  const auto hung = AskHung(40);
  for (const auto& client : hung) {
    EXPECT_TRUE(WaitWhileTimePasses([&] { return client->HasInput(); }));
    EXPECT_GE(Since(begin), options_.file_timeout);
    const Response answer = client->Read();
    EXPECT_EQ(answer.result(), http::status::service_unavailable);
    EXPECT_EQ(answer["Retry-After"], "10");
    EXPECT_THAT(answer.body(), HasSubstr("does not answer"));
  }
  EXPECT_EQ(Ask("/").body(), "<html>storm</html>");
}

TEST_F(HungFilesTest, TheGatewayEndsWithoutThem) {
  // The time is static because an abandoned thread may still read it.
  static WatchedTime time;
  options_.time = &time;
  const auto hung = AskHung(1);
  std::atomic<bool> is_stopped{false};
  std::thread stop([&] {
    site_->StopGateway();
    is_stopped = true;
  });
  // The gateway abandons the thread after a few seconds.
  EXPECT_TRUE(testing::WaitFor([&] {
    time.Advance(std::chrono::seconds(1));
    return is_stopped.load();
  }));
  stop.join();
  EXPECT_TRUE(hung.front()->IsEnded());
}

TEST_F(HungFilesTest, WhoCannotBeSentItsBeginningIsToldToTryAgain) {
  // The kernel reports a size for this file that is larger than its readable contents.
  const std::string short_file = "/sys/kernel/address_bits";
  std::error_code error;
  if (std::filesystem::file_size(short_file, error) != 4096) {
    GTEST_SKIP() << "needs " << short_file;
  }
  std::atomic<int> sent{0};
  options_.find_kept_file = [&](std::string_view) {
    return KeptFile{short_file, "short", [&sent] { ++sent; }};
  };
  RawClient client(Site().Port());
  const Response answer = client.Ask("GET", "/results/short/0", {{"Range", "bytes=4000-"}});
  EXPECT_EQ(answer.result(), http::status::service_unavailable);
  EXPECT_EQ(answer["Retry-After"], "10");
  EXPECT_FALSE(answer.count("Content-Range"));
  // The connection stays open after the error response. A failure that occurs after a response has
  // begun ends the connection.
  client.Send("GET /results/short/0 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(client.ReadHeaders().result(), http::status::ok);
  EXPECT_TRUE(client.IsEnded());
  site_->StopGateway();
  EXPECT_EQ(sent, 0);
}

TEST_F(HungFilesTest, PartsOfResultsAreSent) {
  const Response part =
      RawClient(Site().Port()).Ask("GET", "/results/fine/0", {{"Range", "bytes=2-4"}});
  EXPECT_EQ(part.result(), http::status::partial_content);
  EXPECT_EQ(part.body(), "ctu");
  EXPECT_EQ(part["Content-Range"], "bytes 2-4/7");
  // Numbers have no sign, and a wrong range asks for the whole file.
  for (const std::string range : {"bytes=+2-4", "bytes=2-+4", "bytes=-+4", "bytes= 2-4"}) {
    const Response whole =
        RawClient(Site().Port()).Ask("GET", "/results/fine/0", {{"Range", range}});
    EXPECT_EQ(whole.result(), http::status::ok) << range;
    EXPECT_EQ(whole.body().size(), 7U) << range;
  }
  // Only GET supports ranges.
  for (const std::string range : {"bytes=2-4", "bytes=7-"}) {
    const Response head =
        RawClient(Site().Port()).Ask("HEAD", "/results/fine/0", {{"Range", range}});
    EXPECT_EQ(head.result(), http::status::ok) << range;
    EXPECT_EQ(head["Content-Length"], "7");
  }
}

}  // namespace
}  // namespace thunderhead::gateway::test
