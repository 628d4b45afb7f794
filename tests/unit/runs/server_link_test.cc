#include "runs/server_link.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServerLinkTest : public ::testing::Test {
 protected:
  // No call is made, so nothing has to listen at this address.
  ServerLink link_{{.address = "127.0.0.1:1", .token = "", .tls_roots = ""}};

  absl::Status StatusOf(grpc::StatusCode code, const std::string& text) const {
    return link_.StatusOf(grpc::Status(code, text));
  }
};

TEST_F(ServerLinkTest, SaysWhetherTheServerCannotBeReachedOrIsSlow) {
  const absl::Status away = StatusOf(grpc::StatusCode::UNAVAILABLE, "refused");
  EXPECT_TRUE(absl::IsUnavailable(away));
  EXPECT_THAT(std::string(away.message()),
              HasSubstr("the server at 127.0.0.1:1 cannot be reached"));
  const absl::Status slow = StatusOf(grpc::StatusCode::DEADLINE_EXCEEDED, "too late");
  EXPECT_TRUE(absl::IsDeadlineExceeded(slow));
  EXPECT_THAT(std::string(slow.message()),
              HasSubstr("the server at 127.0.0.1:1 has not answered in time"));
  EXPECT_THAT(std::string(slow.message()), Not(HasSubstr("reached")));
}

TEST_F(ServerLinkTest, AMissingCallNeedNotBeOneOfRenderJobs) {
  const absl::Status missing = StatusOf(grpc::StatusCode::UNIMPLEMENTED, "no ListStorms");
  EXPECT_TRUE(absl::IsUnimplemented(missing));
  EXPECT_EQ(missing.message(),
            "the server at 127.0.0.1:1 lacks a call that this program needs; run both in the same "
            "version (no ListStorms)");
}

TEST_F(ServerLinkTest, AStopIsNoFaultOfTheServer) {
  std::stop_source stop;
  link_.StopOn(stop.get_token());
  stop.request_stop();
  EXPECT_TRUE(absl::IsCancelled(StatusOf(grpc::StatusCode::DEADLINE_EXCEEDED, "")));
}

sockaddr_in Loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<in_port_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

// Forwards connections to a port of this machine until it is frozen. From then on it forwards
// nothing, but keeps the connections, like a network that vanishes.
class Network {
 public:
  explicit Network(int to) : to_(to), listening_(socket(AF_INET, SOCK_STREAM, 0)) {
    const sockaddr_in any = Loopback(0);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
    EXPECT_EQ(listen(listening_, 8), 0);
    accepting_ = std::jthread([this] { Accept(); });
  }
  ~Network() {
    shutdown(listening_, SHUT_RDWR);
    accepting_.join();
    close(listening_);
  }
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  std::string Address() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    return absl::StrCat("127.0.0.1:", ntohs(address.sin_port));
  }
  void Freeze() { frozen_ = true; }

 private:
  void Accept() {
    std::vector<int> connections;
    std::vector<std::jthread> pumps;
    for (int client = accept(listening_, nullptr, nullptr); client >= 0;
         client = accept(listening_, nullptr, nullptr)) {
      const int server = socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in address = Loopback(to_);
      EXPECT_EQ(connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
      connections.insert(connections.end(), {client, server});
      pumps.emplace_back([this, client, server] { Pump(client, server); });
      pumps.emplace_back([this, client, server] { Pump(server, client); });
    }
    for (const int connection : connections) shutdown(connection, SHUT_RDWR);
    pumps.clear();
    for (const int connection : connections) close(connection);
  }

  void Pump(int from, int to) const {
    std::array<char, 4096> bytes;
    while (true) {
      const ssize_t count = recv(from, bytes.data(), bytes.size(), 0);
      if (count <= 0) return;
      if (!frozen_) send(to, bytes.data(), static_cast<std::size_t>(count), MSG_NOSIGNAL);
    }
  }

  const int to_;
  const int listening_;
  std::atomic<bool> frozen_ = false;
  std::jthread accepting_;
};

// Answers no call.
class SilentServer : public v1::ThunderheadService::Service {
 public:
  SilentServer() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~SilentServer() override { server_->Shutdown(std::chrono::system_clock::now()); }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;

  grpc::Status ListStorms(grpc::ServerContext* context, const v1::ListStormsRequest*,
                          v1::ListStormsResponse*) override {
    asked_ = true;
    testing::WaitFor([context] { return context->IsCancelled(); });
    return grpc::Status::CANCELLED;
  }

  int Port() const { return port_; }
  bool IsAsked() const { return asked_; }

 private:
  std::atomic<bool> asked_ = false;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST(VanishedNetworkTest, EndsCalls) {
  SilentServer server;
  Network network(server.Port());
  ServerLink link({.address = network.Address(),
                   .token = "",
                   .tls_roots = "",
                   .ping_interval = std::chrono::seconds(1),
                   .ping_timeout = std::chrono::seconds(1)});
  const std::jthread vanish([&] {
    testing::WaitFor([&] { return server.IsAsked(); });
    network.Freeze();
  });
  v1::ListStormsResponse response;
  // Without pings, the call would end by its deadline.
  EXPECT_TRUE(
      absl::IsUnavailable(link.Call(link.Service(), &v1::ThunderheadService::Stub::ListStorms,
                                    v1::ListStormsRequest(), &response)));
}

}  // namespace
}  // namespace thunderhead::runs
