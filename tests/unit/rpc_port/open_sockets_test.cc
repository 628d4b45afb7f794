// Tests which connection of gRPC's port is closed in favour of a new one.
#include "rpc_port/open_sockets.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/file_descriptor.h"
#include "gtest/gtest.h"

namespace thunderhead::rpc_port {
namespace {

using std::chrono::seconds;

class OpenSocketsTest : public ::testing::Test {
 protected:
  OpenSockets Of(std::size_t most, std::size_t most_per_address) {
    return {most, most_per_address, {}, calls_, [this](int socket) { return PeerOf(socket); }};
  }

  // Opens a connection of that peer, a second after the previous one. Returns true if it is
  // accepted.
  bool Take(OpenSockets& open, const std::string& peer) {
    const int socket = kNoDescriptor + taken_;
    now_ += seconds(1);
    const bool taken = open.Take(socket, peer, now_);
    if (taken) {
      peers_[socket] = peer;
      ++taken_;
    }
    return taken;
  }
  std::optional<std::string> PeerOf(int socket) {
    looked_for_ = socket - kNoDescriptor;
    const auto peer = peers_.find(socket);
    return peer == peers_.end() ? std::nullopt : std::optional(peer->second);
  }

  // No descriptor has such a number, so no socket is shut down.
  static constexpr int kNoDescriptor = 1 << 28;

  const std::shared_ptr<ConnectionCalls> calls_ = std::make_shared<ConnectionCalls>();
  std::map<int, std::string> peers_;
  int taken_ = 0;
  // Index, in order of acceptance, of the last socket whose peer was looked up. OpenSockets looks
  // up the peer before it closes a connection.
  int looked_for_ = -1;
  OpenSockets::Clock::time_point now_ = OpenSockets::Clock::now();
};

TEST_F(OpenSocketsTest, TheOldestOfTheNetworkWithMostMakesRoom) {
  OpenSockets open = Of(4, 4);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  EXPECT_TRUE(Take(open, "192.0.2.2:1"));
  EXPECT_TRUE(Take(open, "192.0.2.2:2"));
  EXPECT_TRUE(Take(open, "192.0.2.2:3"));
  EXPECT_TRUE(Take(open, "192.0.2.3:1"));
  EXPECT_EQ(looked_for_, 1);
}

TEST_F(OpenSocketsTest, AddressesOfOneNetworkOfIpv6AreOne) {
  OpenSockets open = Of(100, 2);
  EXPECT_TRUE(Take(open, "[2001:db8::1]:1"));
  EXPECT_TRUE(Take(open, "[2001:db8::2]:1"));
  EXPECT_TRUE(Take(open, "[2001:db8:0:1::3]:1"));
  EXPECT_EQ(looked_for_, -1) << "another network";
  EXPECT_TRUE(Take(open, "[2001:db8::3]:1"));
  EXPECT_EQ(looked_for_, 0);
}

TEST_F(OpenSocketsTest, ThoseWithCallsStay) {
  OpenSockets open = Of(100, 2);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  const auto call = calls_->Begin("192.0.2.1:1");
  EXPECT_TRUE(Take(open, "192.0.2.1:2"));
  EXPECT_TRUE(Take(open, "192.0.2.1:3"));
  EXPECT_EQ(looked_for_, 1);
  const auto other = calls_->Begin("192.0.2.1:3");
  EXPECT_FALSE(Take(open, "192.0.2.1:4"));
}

TEST_F(OpenSocketsTest, ThoseThatHadACallGoLast) {
  OpenSockets open = Of(100, 2);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  static_cast<void>(calls_->Begin("192.0.2.1:1"));
  EXPECT_TRUE(Take(open, "192.0.2.1:2"));
  now_ += seconds(60);
  EXPECT_TRUE(Take(open, "192.0.2.1:3"));
  EXPECT_EQ(looked_for_, 1);
  const auto call = calls_->Begin("192.0.2.1:3");
  EXPECT_TRUE(Take(open, "192.0.2.1:4"));
  EXPECT_EQ(looked_for_, 0);
}

TEST_F(OpenSocketsTest, ThoseThatAreClosedCountNoMore) {
  OpenSockets open = Of(100, 2);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  EXPECT_TRUE(Take(open, "192.0.2.1:2"));
  const auto first = calls_->Begin("192.0.2.1:1");
  const auto second = calls_->Begin("192.0.2.1:2");
  EXPECT_FALSE(Take(open, "192.0.2.1:3"));
  peers_.erase(kNoDescriptor);
  EXPECT_TRUE(Take(open, "192.0.2.1:3"));
  const auto third = calls_->Begin("192.0.2.1:3");
  EXPECT_FALSE(Take(open, "192.0.2.1:4"));
}

// A client's system may reuse the port of a closed connection for the next one, which has another
// descriptor here. The server notices only later that the first is closed.
TEST_F(OpenSocketsTest, OneThatIsClosedTakesNoUseFromAnotherOfTheSamePeer) {
  OpenSockets open = Of(100, 3);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  static_cast<void>(calls_->Begin("192.0.2.1:1"));
  peers_.erase(kNoDescriptor);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  EXPECT_FALSE(calls_->UseOf("192.0.2.1:1").has_value()) << "of the one before";
  const auto call = calls_->Begin("192.0.2.1:1");
  // The descriptor's number is reused, and there are as many connections as allowed.
  EXPECT_TRUE(open.Take(kNoDescriptor, "192.0.2.1:7", now_));
  for (const char* peer : {"192.0.2.1:2", "192.0.2.1:3", "192.0.2.1:4"}) {
    EXPECT_TRUE(Take(open, peer));
    EXPECT_EQ(calls_->UseOf("192.0.2.1:1")->calls, 1U);
  }
}

// A TCP connection of this machine with itself.
struct Connected {
  Connected() {
    const base::FileDescriptor listener(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* const address = reinterpret_cast<sockaddr*>(&at);
    socklen_t bytes = sizeof(at);
    EXPECT_EQ(bind(listener.Get(), address, bytes), 0);
    EXPECT_EQ(listen(listener.Get(), 1), 0);
    EXPECT_EQ(getsockname(listener.Get(), address, &bytes), 0);
    EXPECT_EQ(connect(client.Get(), address, bytes), 0);
    server = base::FileDescriptor(accept(listener.Get(), nullptr, nullptr));
    EXPECT_EQ(send(client.Get(), "abc", 3, 0), 3);
  }
  // Returns how many bytes the server can read, or -1 if the connection has been reset.
  ssize_t ServerReads() const {
    char read[8];
    return recv(server.Get(), read, sizeof(read), MSG_DONTWAIT);
  }

  base::FileDescriptor client{::socket(AF_INET, SOCK_STREAM, 0)};
  base::FileDescriptor server;
};

TEST_F(OpenSocketsTest, AllOfANetworkAreAbortedAndWhatTheySentIsDropped) {
  OpenSockets open = Of(4, 4);
  const Connected first;
  const Connected second;
  const Connected other;
  const auto take = [&](const Connected& connected, const std::string& peer) {
    peers_[connected.server.Get()] = peer;
    EXPECT_TRUE(open.Take(connected.server.Get(), peer, now_));
  };
  take(first, "192.0.2.1:1");
  take(second, "192.0.2.1:2");
  take(other, "192.0.2.2:1");
  open.AbortNetworkOf("192.0.2.1:1");
  EXPECT_EQ(first.ServerReads(), -1);
  EXPECT_EQ(second.ServerReads(), -1);
  EXPECT_EQ(other.ServerReads(), 3);
}

TEST_F(OpenSocketsTest, TheNetworkThatSendsMostIsFound) {
  const base::TrustedProxies proxies = *base::TrustedProxies::Parse({"192.0.2.3"});
  OpenSockets open(9, 9, proxies, calls_, [this](int socket) { return PeerOf(socket); });
  const Connected little;
  const Connected much;
  const Connected proxy;
  const std::string text(5000, 'x');
  for (const Connected* const connected : {&much, &proxy, &proxy}) {
    EXPECT_EQ(send(connected->client.Get(), text.data(), text.size(), 0), 5000);
  }
  EXPECT_FALSE(open.WhoSendsMost().has_value());
  const auto take = [&](const Connected& connected, const std::string& peer) {
    peers_[connected.server.Get()] = peer;
    EXPECT_TRUE(open.Take(connected.server.Get(), peer, now_));
  };
  take(little, "192.0.2.1:1");
  EXPECT_FALSE(open.WhoSendsMost().has_value()) << "too little for a flood";
  take(much, "192.0.2.2:1");
  take(proxy, "192.0.2.3:1");
  EXPECT_EQ(open.WhoSendsMost(), "192.0.2.2:1");
}

TEST_F(OpenSocketsTest, ADescriptorThatAnotherConnectionHasGotIsNotAborted) {
  OpenSockets open = Of(4, 4);
  const Connected connected;
  ASSERT_TRUE(open.Take(connected.server.Get(), "192.0.2.1:1", now_));
  peers_[connected.server.Get()] = "192.0.2.2:1";
  open.AbortNetworkOf("192.0.2.1:1");
  EXPECT_EQ(connected.ServerReads(), 3);
}

TEST_F(OpenSocketsTest, ThoseWithoutACallAreClosedAfterAWhile) {
  OpenSockets open = Of(4, 4);
  EXPECT_TRUE(Take(open, "192.0.2.1:1"));
  EXPECT_TRUE(Take(open, "192.0.2.1:2"));
  EXPECT_TRUE(Take(open, "192.0.2.1:3"));
  const auto call = calls_->Begin("192.0.2.1:2");
  calls_->Begin("192.0.2.1:3").reset();  // the last use of this connection is now
  const auto last = OpenSockets::Clock::now();
  const auto closes = [&](OpenSockets::Clock::time_point now) {
    looked_for_ = -1;
    open.CloseUnused(seconds(60), now);
    return looked_for_;
  };
  EXPECT_TRUE(calls_->UseOf("192.0.2.1:3").has_value());
  closes(last + seconds(59));
  EXPECT_TRUE(calls_->UseOf("192.0.2.1:3").has_value());
  closes(last + seconds(61));
  EXPECT_FALSE(calls_->UseOf("192.0.2.1:3").has_value()) << "closed, and forgotten";
  EXPECT_TRUE(calls_->UseOf("192.0.2.1:2").has_value()) << "it has a call";
  // Two more connections are allowed.
  EXPECT_TRUE(Take(open, "192.0.2.2:1"));
  looked_for_ = -1;
  EXPECT_TRUE(Take(open, "192.0.2.2:2"));
  EXPECT_EQ(looked_for_, -1) << "none had to make room";
}

}  // namespace
}  // namespace thunderhead::rpc_port
