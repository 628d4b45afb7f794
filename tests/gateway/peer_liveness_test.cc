#include "gateway/peer_liveness.h"

#include <gtest/gtest.h>

namespace thunderhead::gateway {
namespace {

using std::chrono::milliseconds;
using Verdict = PeerLiveness::Verdict;

// A fixture that pings a peer that has been silent for 100 ms, treats writes as stalled after 300
// ms, and closes within 200 ms.
class PeerLivenessTest : public ::testing::Test {
 protected:
  Verdict At(int ms) { return liveness_.Judge(seen_, begin_ + milliseconds(ms)); }

  const PeerLiveness::Clock::time_point begin_ = PeerLiveness::Clock::now();
  PeerLiveness liveness_{{milliseconds(100), milliseconds(300), milliseconds(200)}, begin_};
  PeerLiveness::Observation seen_;
};

TEST_F(PeerLivenessTest, SilentPeerIsPingedThenDropped) {
  EXPECT_EQ(At(99), Verdict::kFine);
  EXPECT_EQ(At(100), Verdict::kPing);
  EXPECT_EQ(At(150), Verdict::kFine);
  EXPECT_EQ(At(200), Verdict::kDrop);
}

TEST_F(PeerLivenessTest, AnAnswerStartsOver) {
  EXPECT_EQ(At(100), Verdict::kPing);
  seen_.received_bytes = 6;
  EXPECT_EQ(At(190), Verdict::kFine);
  EXPECT_EQ(At(289), Verdict::kFine);
  EXPECT_EQ(At(290), Verdict::kPing);
}

TEST_F(PeerLivenessTest, PeerThatStillTakesInWhatPrecedesThePingStays) {
  seen_.sent_bytes = 1000;
  EXPECT_EQ(At(100), Verdict::kPing);
  seen_.sent_bytes = 1002;
  for (int i = 1; i <= 10; ++i) {
    seen_.delivered_bytes = i * 100;
    EXPECT_EQ(At(100 + 90 * i), Verdict::kFine);
  }
  seen_.delivered_bytes = 1002;
  EXPECT_EQ(At(1050), Verdict::kFine);
  // From here on the peer has received the ping, and further received bytes do not count as an
  // answer.
  seen_.sent_bytes = seen_.delivered_bytes = 2000;
  EXPECT_EQ(At(1149), Verdict::kFine);
  seen_.sent_bytes = seen_.delivered_bytes = 3000;
  EXPECT_EQ(At(1150), Verdict::kDrop);
}

TEST_F(PeerLivenessTest, PingThatCannotBeSentYetIsNotUnanswered) {
  EXPECT_EQ(At(100), Verdict::kPing);
  seen_.is_writing = seen_.is_pinging = true;
  for (int i = 1; i <= 10; ++i) {
    seen_.sent_bytes = seen_.delivered_bytes = i * 100;
    EXPECT_EQ(At(100 + 90 * i), Verdict::kFine);
  }
  EXPECT_EQ(At(1100), Verdict::kDrop);
}

TEST_F(PeerLivenessTest, PeerThatIsHeldBackNeedOnlyTakePings) {
  seen_.is_reading = false;
  for (int i = 1; i <= 5; ++i) {
    EXPECT_EQ(At(100 * i), Verdict::kPing);
    seen_.sent_bytes += 2;
    EXPECT_EQ(At(100 * i + 1), Verdict::kFine);
    seen_.delivered_bytes += 2;
    EXPECT_EQ(At(100 * i), Verdict::kFine);
  }
  EXPECT_EQ(At(600), Verdict::kPing);
  seen_.sent_bytes += 2;
  EXPECT_EQ(At(699), Verdict::kFine);
  EXPECT_EQ(At(700), Verdict::kDrop);
}

TEST_F(PeerLivenessTest, WriteWithoutProgressIsStalled) {
  seen_.received_bytes = 1;
  EXPECT_EQ(At(1000), Verdict::kFine);
  seen_.is_writing = true;
  const auto judge_answering_peer = [&](int ms) {
    ++seen_.received_bytes;
    return At(ms);
  };
  EXPECT_EQ(judge_answering_peer(1010), Verdict::kFine);
  EXPECT_EQ(judge_answering_peer(1300), Verdict::kFine);
  seen_.sent_bytes = 1;
  EXPECT_EQ(judge_answering_peer(1305), Verdict::kFine);
  EXPECT_EQ(judge_answering_peer(1604), Verdict::kFine);
  EXPECT_EQ(judge_answering_peer(1605), Verdict::kDrop);
}

TEST_F(PeerLivenessTest, ClosingEndsUnlessSomethingIsStillBeingDelivered) {
  seen_.is_closing = true;
  EXPECT_EQ(At(50), Verdict::kFine);
  seen_.delivered_bytes = 1;
  EXPECT_EQ(At(200), Verdict::kFine);
  // Bytes that the client still sends do not prolong the wait.
  seen_.received_bytes = 1000;
  EXPECT_EQ(At(399), Verdict::kFine);
  EXPECT_EQ(At(400), Verdict::kDrop);
}

}  // namespace
}  // namespace thunderhead::gateway
