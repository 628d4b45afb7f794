// Clients that open connections and say or read little lock nobody out.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/gateway/echo_service.h"
#include "tests/gateway/eventually.h"
#include "tests/gateway/raw_client.h"
#include "tests/gateway/websocket_client.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::gateway::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
namespace http = boost::beast::http;

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
      // Fails where the server has already closed it.
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

// In which another client has the page. ThreadSanitizer makes the gateway some ten times slower.
#ifdef __SANITIZE_THREAD__
constexpr milliseconds kSoon{10'000};
#else
constexpr milliseconds kSoon{1000};
#endif

class SlowClientsTest : public ::testing::Test {
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

  EchoSite& Site() {
    if (site_ == nullptr) site_ = EchoSite::Start(options_);
    return *site_;
  }

  // How long another client's page takes.
  milliseconds LoadPage() {
    const auto start = steady_clock::now();
    RawClient client(Site().Port());
    EXPECT_EQ(client.Ask("GET", "/").body(), "<html>storm</html>");
    return std::chrono::ceil<milliseconds>(steady_clock::now() - start);
  }

  testing::TemporaryFolder folder_;
  GatewayOptions options_;
  std::unique_ptr<EchoSite> site_;
};

TEST_F(SlowClientsTest, HalfOpenSocketsLockNobodyOut) {
  // As many as there may be, and twice as many again.
  const SilentSockets silent(Site().Port(), 768, "");
  EXPECT_LT(LoadPage(), kSoon);
  const SilentSockets half_said(Site().Port(), 768, "GET / HTTP/1.1\r\nHo");
  EXPECT_LT(LoadPage(), kSoon);
  const SilentSockets half_sent(Site().Port(), 768,
                                "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\n"
                                "Host: localhost\r\nContent-Type: application/grpc-web\r\n"
                                "Content-Length: 100\r\n\r\n");
  EXPECT_LT(LoadPage(), kSoon);
}

TEST_F(SlowClientsTest, SilentWebSocketsLockNobodyOut) {
  const SilentSockets silent(Site().Port(), 768,
                             "GET /thunderhead.gateway.test.Echo/Converse HTTP/1.1\r\n"
                             "Host: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                             "Sec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                             "Sec-WebSocket-Protocol: grpc-websocket.v1\r\n\r\n");
  EXPECT_LT(LoadPage(), kSoon);
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
  // By IPv6 it is "::ffff:127.0.0.1".
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

// Sends a byte every 20 ms until the server ends the connection; returns how long that took.
milliseconds Dribble(uint16_t port, const std::string& bytes) {
  RawClient client(port);
  const auto start = steady_clock::now();
  client.SendUntilClosed(bytes);
  std::thread dribbling([&] {
    for (int i = 0; i < 200; ++i) {
      std::this_thread::sleep_for(milliseconds(20));
      client.SendNow("x");
    }
  });
  EXPECT_TRUE(client.IsEnded());
  const auto took = std::chrono::ceil<milliseconds>(steady_clock::now() - start);
  dribbling.join();
  return took;
}

TEST_F(SlowClientsTest, AHeaderHasATimeHoweverOftenBytesCome) {
  options_.header_timeout = milliseconds(300);
  EXPECT_LT(Dribble(Site().Port(), "GET /"), milliseconds(1500));
}

TEST_F(SlowClientsTest, ABodyHasATimeHoweverOftenBytesCome) {
  options_.header_timeout = milliseconds(200);
  EXPECT_LT(Dribble(Site().Port(),
                    "POST /thunderhead.gateway.test.Echo/Say HTTP/1.1\r\nHost: localhost\r\n"
                    "Content-Type: application/grpc-web\r\nContent-Length: 5000\r\n\r\n"),
            milliseconds(2000));
  EXPECT_EQ(Site().Record().started, 0);
}

TEST_F(SlowClientsTest, AFileMustBeReadAtALeastRate) {
  options_.header_timeout = milliseconds(100);
  options_.min_bytes_per_second = 1e9;
  RawClient client(Site().Port(), 64 << 10);
  client.Send("GET /big.js HTTP/1.1\r\nHost: localhost\r\n\r\n");
  client.ReadHeaders();
  // Some progress, always; the connection ends long before it has a third of it.
  EXPECT_ANY_THROW({
    for (int i = 1; i < 400; ++i) {
      std::this_thread::sleep_for(milliseconds(10));
      client.ReadBody(static_cast<size_t>(i) * 20'000);
    }
  });
}

// A request of Count for messages of that size.
std::string Sized(uint32_t count, uint32_t payload_bytes) {
  CountRequest request;
  request.set_count(count);
  request.set_payload_bytes(payload_bytes);
  return request.SerializeAsString();
}

TEST_F(SlowClientsTest, AnAnswerMustBeTakenAtALeastRate) {
  options_.header_timeout = milliseconds(100);
  options_.min_bytes_per_second = 1e9;
  RawClient client(Site().Port(), 64 << 10);
  client.Send(CallRequest("Count", Frame(Sized(1, 30'000'000))));
  client.ReadHeaders();
  // Some progress, always; the connection ends long before it has a third of it.
  EXPECT_ANY_THROW({
    for (int i = 1; i < 400; ++i) {
      std::this_thread::sleep_for(milliseconds(10));
      client.ReadBody(static_cast<size_t>(i) * 20'000);
    }
  });
  EXPECT_TRUE(Eventually([&] { return Site().Record().done == 1; }));
}

TEST_F(SlowClientsTest, AWebSocketMustTakeItsMessagesAtALeastRate) {
  options_.header_timeout = milliseconds(300);
  options_.min_bytes_per_second = 1e9;
  WebSocketClient client(Site().Port(), {"Count", {}, /*receive_buffer_bytes=*/16 << 10});
  client.Send(std::string(1, '\0') + Sized(20, 3'000'000));
  // It takes none of them.
  EXPECT_TRUE(Eventually([&] { return Site().Record().cancelled == 1; }));
}

TEST_F(SlowClientsTest, AnswersThatNobodyTakesHaveALimitInAll) {
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
  // It has had its time.
  std::this_thread::sleep_for(milliseconds(5500));
  const CallResult result = Call(Site().Port(), "Count", Sized(1, 30'000'000));
  EXPECT_EQ(result.Trailer("grpc-status"), "0");
  EXPECT_TRUE(hoarder.IsEnded());
}

// Debian's slowhttptest, in its modes of slow headers, bodies and reading.
TEST_F(SlowClientsTest, Slowhttptest) {
  const char* const program = "/usr/bin/slowhttptest";
  if (!std::filesystem::exists(program)) {
    GTEST_SKIP() << "needs " << program << ": install Debian's package slowhttptest";
  }
  const std::string url = absl::StrCat("http://127.0.0.1:", Site().Port(), "/");
  for (const std::string mode :
       {"-H -i 1 -x 24", "-B -i 1 -s 8192 -x 10", "-X -w 1 -y 2 -n 1 -z 1 -k 3"}) {
    std::thread attack([&] {
      const std::string command = absl::StrCat("timeout 20 ", program, " ", mode,
                                               " -c 1000 -r 500 -l 6 -u ", url, " >/dev/null 2>&1");
      static_cast<void>(std::system(command.c_str()));
    });
    milliseconds slowest{0};
    for (int i = 0; i < 20; ++i) {
      std::this_thread::sleep_for(milliseconds(250));
      slowest = std::max(slowest, LoadPage());
    }
    attack.join();
    EXPECT_LT(slowest, milliseconds(1000)) << mode;
    RecordProperty(mode.substr(1, 1), static_cast<int>(slowest.count()));
  }
}

}  // namespace
}  // namespace thunderhead::gateway::test
