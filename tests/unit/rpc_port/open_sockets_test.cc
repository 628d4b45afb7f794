// Tests which connection of gRPC's port is closed in favour of a new one.
#include "rpc_port/open_sockets.h"

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

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
  // Number, in order of acceptance, of the last socket that was looked up to be closed.
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
