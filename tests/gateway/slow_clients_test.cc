// Tests that clients which open connections but send or read little do not lock out other clients.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/websocket_client.h"
#include "tests/support/figure.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;
namespace http = boost::beast::http;
using testing::WaitFor;

// Connections that send some bytes and then nothing.
class SilentSockets {
 public:
  SilentSockets(uint16_t port, int count, const std::string& bytes) {
    for (int i = 0; i < count; ++i) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(port);
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
      sockets_.push_back(socket);
      EXPECT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
      // Sending fails if the server has already closed the socket.
      static_cast<void>(send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL));
    }
  }
  ~SilentSockets() {
    for (const int socket : sockets_) close(socket);
  }
  SilentSockets(const SilentSockets&) = delete;
  SilentSockets& operator=(const SilentSockets&) = delete;

 private:
  std::vector<int> sockets_;
};

class SlowClientsTest : public EchoTest {
 protected:
  SlowClientsTest() {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    std::ofstream(folder_.File("index.html")) << "<html>storm</html>";
    std::ofstream(folder_.File("big.js")) << std::string(30'000'000, 'x');
    options_.page_directory = folder_.Path().string();
  }
  ~SlowClientsTest() override { site_.reset(); }

  // Loads the page for another client, and returns how long that takes.
  milliseconds LoadPage() {
    const auto start = steady_clock::now();
    RawClient client(Site().Port());
    EXPECT_EQ(client.Ask("GET", "/").body(), "<html>storm</html>");
    return std::chrono::ceil<milliseconds>(steady_clock::now() - start);
  }

  testing::TemporaryFolder folder_;
};

// If half-open sockets locked out other clients, LoadPage() would wait for a timeout that no test
// reaches.
TEST_F(SlowClientsTest, HalfOpenSocketsLockNobodyOut) {
  // Each of the three sets of connections is as large as the limit of the server.
  const SilentSockets silent(Site().Port(), 768, "");
  LoadPage();
  const SilentSockets half_said(Site().Port(), 768, "GET / HTTP/1.1\r\nHo");
  LoadPage();
  const SilentSockets half_sent(Site().Port(), 768,
                                "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\n"
                                "Host: localhost\r\nContent-Type: application/grpc-web\r\n"
                                "Content-Length: 100\r\n\r\n");
  LoadPage();
}

TEST_F(SlowClientsTest, SilentWebSocketsLockNobodyOut) {
  const SilentSockets silent(Site().Port(), 768,
                             "GET /thunderhead.gateway.test.Echo/Converse HTTP/1.1\r\n"
                             "Host: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                             "Sec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                             "Sec-WebSocket-Protocol: grpc-websocket.v1\r\n\r\n");
  LoadPage();
}

class SlowClientsBenchmark : public SlowClientsTest {};

TEST_F(SlowClientsBenchmark, PageNextToHalfOpenSockets) {
  const SilentSockets silent(Site().Port(), 768, "GET / HTTP/1.1\r\nHo");
  testing::Figure("page next to 768 half-open connections", static_cast<double>(LoadPage().count()),
                  "ms");
}

TEST_F(SlowClientsTest, AnAddressThatHasItsShareMakesRoomItself) {
  options_.max_connections_per_address = 2;
  RawClient first(Site().Port());
  RawClient second(Site().Port());
  EXPECT_EQ(second.Ask("GET", "/").result(), http::status::ok);
  LoadPage();
  EXPECT_TRUE(first.IsClosed());
  EXPECT_EQ(second.Ask("GET", "/").result(), http::status::ok);
}

TEST_F(SlowClientsTest, Ipv4AndIpv6AreNotOneAddress) {
  options_.address = "::";
  options_.max_connections_per_address = 1;
  const int v6 = socket(AF_INET6, SOCK_STREAM, 0);
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_port = htons(Site().Port());
  address.sin6_addr = in6addr_loopback;
  ASSERT_EQ(connect(v6, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  // As an IPv6 address it is "::ffff:127.0.0.1".
  RawClient v4(Site().Port());
  EXPECT_EQ(v4.Ask("GET", "/").result(), http::status::ok);
  char byte = 0;
  EXPECT_EQ(recv(v6, &byte, 1, MSG_DONTWAIT), -1) << "it was closed";
  close(v6);
}

TEST_F(SlowClientsTest, CallsDoNotMakeRoom) {
  options_.max_connections = 2;
  WebSocketClient first(Site().Port());
  WebSocketClient second(Site().Port());
  const std::string message("\0\x0a\x05storm", 8);
  for (WebSocketClient* const client : {&first, &second}) {
    client->Send(message);
    EXPECT_TRUE(client->Receive().has_value());
  }
  EXPECT_TRUE(RawClient(Site().Port()).IsClosed());
  for (WebSocketClient* const client : {&first, &second}) {
    client->Send(message);
    EXPECT_TRUE(client->Receive().has_value());
  }
  first.Vanish();
  second.Vanish();
}

class DribblingTest : public SlowClientsTest {
 protected:
  // Sends a byte each second until the server ends the connection. Returns how long that takes.
  WatchedTime::Clock::duration Dribble(const std::string& bytes) {
    DriveTime();
    const auto begin = time_.Now();
    RawClient client(Site().Port());
    client.SendUntilClosed(bytes);
    std::atomic<bool> has_ended{false};
    std::thread dribbling([&] {
      WaitWhileTimePasses([&] {
        client.SendNow("x");
        return has_ended.load();
      });
    });
    EXPECT_TRUE(client.IsEnded());
    const auto took = Since(begin);
    has_ended = true;
    dribbling.join();
    return took;
  }
};

TEST_F(DribblingTest, AHeaderHasATimeHoweverOftenBytesCome) {
  options_.header_timeout = seconds(10);
  EXPECT_GE(Dribble("GET /"), options_.header_timeout);
}

TEST_F(DribblingTest, ABodyHasATimeHoweverOftenBytesCome) {
  options_.header_timeout = seconds(10);
  EXPECT_GE(Dribble("POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\nHost: localhost\r\n"
                    "Content-Type: application/grpc-web\r\nContent-Length: 1000000\r\n\r\n"),
            options_.header_timeout);
  EXPECT_EQ(Site().Record().started, 0);
}

// A fixture that lets time pass for a client that takes 30 MB. The client must do so within 30 s
// plus the time at the minimum rate.
class LeastRateTest : public SlowClientsTest {
 protected:
  LeastRateTest() {
    DriveTime();
    options_.header_timeout = seconds(10);
    options_.min_bytes_per_second = 1e9;
    // While this client is connected, the gateway waits for one of its timeouts by time_.
    // AwaitLooks() needs such a waiter.
    waiting_ = std::make_unique<RawClient>(Site().Port());
    EXPECT_EQ(waiting_->Ask("GET", "/healthz").result(), http::status::ok);
  }

  // Checks that the gateway disconnects the client, although the client makes progress all the
  // time.
  void TakesTooLong(RawClient& client) {
    client.ReadHeaders();
    client.ReadBody(1'000'000);
    time_.Advance(seconds(29));
    EXPECT_TRUE(time_.AwaitLooks());
    client.ReadBody(15'000'000);
    time_.Advance(seconds(2));
    EXPECT_TRUE(time_.AwaitLooks());
    // The kernel buffers fewer than the remaining bytes, so the client cannot read all of them.
    EXPECT_ANY_THROW(client.ReadBody(30'000'000));
  }

  std::unique_ptr<RawClient> waiting_;
};

TEST_F(LeastRateTest, OfAFile) {
  RawClient client(Site().Port(), 64 << 10);
  client.Send("GET /big.js HTTP/1.1\r\nHost: localhost\r\n\r\n");
  TakesTooLong(client);
}

// Returns a request of Count for messages of that size.
std::string Sized(uint32_t count, uint32_t payload_bytes) {
  CountRequest request;
  request.set_count(count);
  request.set_payload_bytes(payload_bytes);
  return request.SerializeAsString();
}

TEST_F(LeastRateTest, OfAnAnswer) {
  RawClient client(Site().Port(), 64 << 10);
  client.Send(CallRequest("Count", Frame(Sized(1, 30'000'000))));
  TakesTooLong(client);
  EXPECT_TRUE(WaitFor([&] { return Record().done == 1; }));
}

TEST_F(LeastRateTest, OfMessagesOfAWebSocket) {
  WebSocketClient client(Site().Port(), {"Count", {}, /*receive_buffer_bytes=*/16 << 10});
  client.Send(std::string(1, '\0') + Sized(20, 3'000'000));
  // The client takes none of the messages. The timeout counts from the beginning of a message.
  ASSERT_TRUE(WaitFor([&] { return Record().written > 0; }));
  const auto begin = time_.Now();
  EXPECT_TRUE(WaitWhileTimePasses([&] { return Record().cancelled == 1; }));
  EXPECT_GE(Since(begin), 3 * options_.header_timeout);
}

TEST_F(SlowClientsTest, AnswersThatNobodyTakesHaveALimitInAll) {
  DriveTime();
  options_.max_unsent_bytes = 50'000'000;
  RawClient hoarder(Site().Port(), 64 << 10);
  hoarder.Send(CallRequest("Count", Frame(Sized(1, 30'000'000))));
  hoarder.ReadHeaders();
  hoarder.ReadBody(10'000);
  EXPECT_EQ(Call(Site().Port(), "Count", Sized(1, 30'000'000)).Trailer("grpc-status"), "8");
  WebSocketClient viewer(Site().Port(), {"Count", {}, 0});
  viewer.Send(std::string(1, '\0') + Sized(1, 30'000'000));
  EXPECT_THAT(viewer.Receive().value_or(""), ::testing::HasSubstr("grpc-status:8"));
  EXPECT_EQ(Call(Site().Port(), "Count", Sized(1, 10'000'000)).Trailer("grpc-status"), "0");
  // The time in which the first client must take its response is over.
  time_.Advance(milliseconds(5500));
  const CallResult result = Call(Site().Port(), "Count", Sized(1, 30'000'000));
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
  EXPECT_TRUE(hoarder.IsEnded());
}

// Runs Debian's slowhttptest, in its modes of slow headers, bodies and reading.
TEST_F(SlowClientsTest, Slowhttptest) {
  const char* const program = "/usr/bin/slowhttptest";
  if (!std::filesystem::exists(program)) {
    GTEST_SKIP() << "needs " << program << ": install Debian's package slowhttptest";
  }
  const std::string url = absl::StrCat("http://127.0.0.1:", Site().Port(), "/");
  for (const std::string mode :
       {"-H -i 1 -x 24", "-B -i 1 -s 8192 -x 10", "-X -w 1 -y 2 -n 1 -z 1 -k 3"}) {
    std::atomic<bool> is_over{false};
    std::thread attack([&] {
      const std::string command = absl::StrCat("timeout 600 ", program, " ", mode,
                                               " -c 1000 -r 500 -l 6 -u ", url, " >/dev/null 2>&1");
      static_cast<void>(std::system(command.c_str()));
      is_over = true;
    });
    milliseconds slowest{0};
    while (!is_over) slowest = std::max(slowest, LoadPage());
    attack.join();
    RecordProperty(mode.substr(1, 1), static_cast<int>(slowest.count()));
  }
}

}  // namespace
}  // namespace thunderhead::gateway::test
