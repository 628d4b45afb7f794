#include "gateway/frame_counter.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/gateway/echo_test.h"
#include "tests/gateway/raw_client.h"

namespace thunderhead::gateway {
namespace {

using Time = base::Allowance::Time;

// Returns a masked client frame, with FIN and opcode in the first byte.
std::string FrameOf(unsigned char first, std::size_t payload) {
  std::string frame(1, static_cast<char>(first));
  if (payload < 126) {
    frame += static_cast<char>(0x80 | payload);
  } else if (payload < 65536) {
    frame += static_cast<char>(0x80 | 126);
    for (const int shift : {8, 0}) frame += static_cast<char>(payload >> shift);
  } else {
    frame += static_cast<char>(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(payload >> shift);
  }
  return frame + std::string(4, 'm') + std::string(payload, '\0');
}

class FrameCounterTest : public ::testing::Test {
 protected:
  bool Take(const std::string& bytes) {
    return counter_.Take(std::as_bytes(std::span(bytes)), now_);
  }
  // Returns the number of the first refused frame, counted from 1; -1 if the first 1000 frames are
  // accepted.
  int FramesUntilRefused(const std::string& frame) {
    for (int i = 1; i <= 1000; ++i) {
      if (!Take(frame)) return i;
    }
    return -1;
  }

  Time now_{};
  FrameCounter counter_{now_};
};

constexpr int kBurst = 2 * FrameCounter::kMostEmptyFramesPerSecond;
constexpr unsigned char kBinary = 0x82;
constexpr unsigned char kContinuation = 0x00;
constexpr unsigned char kPing = 0x89;

TEST_F(FrameCounterTest, MessagesAreNotLimited) {
  for (const std::size_t payload : {1, 125, 126, 65535, 65536, 70000}) {
    for (int i = 0; i < kBurst + 50; ++i) EXPECT_TRUE(Take(FrameOf(kBinary, payload))) << payload;
  }
}

TEST_F(FrameCounterTest, EmptyFragmentsAndControlFramesAre) {
  EXPECT_EQ(FramesUntilRefused(FrameOf(kContinuation, 0)), kBurst + 1);
  counter_ = FrameCounter(now_);
  EXPECT_EQ(FramesUntilRefused(FrameOf(kPing, 5)), kBurst + 1);
  EXPECT_FALSE(Take(FrameOf(kBinary, 1))) << "it stays refused";
}

TEST_F(FrameCounterTest, ThoseOfTheLimitAreTakenForEver) {
  for (int second = 0; second < 20; ++second) {
    for (int i = 0; i < FrameCounter::kMostEmptyFramesPerSecond; ++i) {
      EXPECT_TRUE(Take(FrameOf(kPing, 0)));
    }
    now_ += std::chrono::seconds(1);
  }
}

TEST_F(FrameCounterTest, BytesMayComeInAnyPieces) {
  // The payload of the messages looks like empty frames, byte by byte.
  std::string stream;
  for (int i = 0; i < 300; ++i) stream += FrameOf(kBinary, 300);
  for (const char byte : stream) ASSERT_TRUE(Take(std::string(1, byte)));
  stream.clear();
  for (int i = 0; i <= kBurst; ++i) stream += FrameOf(kContinuation, 0);
  bool taken = true;
  for (const char byte : stream) taken = Take(std::string(1, byte));
  EXPECT_FALSE(taken);
}

TEST_F(FrameCounterTest, CloseCodesAbove4999AreRefused) {
  const auto close_with = [](int code) {
    std::string frame = FrameOf(0x88, 2);
    frame[6] = static_cast<char>((code >> 8) ^ 'm');
    frame[7] = static_cast<char>((code & 0xff) ^ 'm');
    return frame;
  };
  EXPECT_TRUE(Take(close_with(4999)));
  EXPECT_FALSE(counter_.HasForbiddenCode());
  // A message or a ping may contain any bytes.
  EXPECT_TRUE(Take(FrameOf(kBinary, 2)));
  EXPECT_TRUE(Take(FrameOf(kPing, 2)));
  EXPECT_TRUE(Take(FrameOf(0x88, 0)));
  for (const char byte : close_with(5000).substr(0, 7)) EXPECT_TRUE(Take(std::string(1, byte)));
  EXPECT_FALSE(Take(close_with(5000).substr(7)));
  EXPECT_TRUE(counter_.HasForbiddenCode());
}

class FloodedWebSocketTest : public test::EchoTest {
 protected:
  // Upgrades, then sends `frames` repeatedly, at most `most` times, until the server accepts none.
  // Returns everything that the server answers after the upgrade until it ends the connection.
  std::string AnswerTo(const std::string& frames, int most) {
    test::RawClient client(Site().Port());
    client.Send(
        "GET /thunderhead.gateway.test.Echo/Converse HTTP/1.1\r\nHost: localhost\r\n"
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        "Sec-WebSocket-Protocol: grpc-websocket.v1\r\n\r\n");
    client.ReadHeaders();
    while (most-- > 0 && client.SendUntilClosed(frames)) {
    }
    client.ShutdownSending();
    return client.ReadToEnd();
  }
};

// A close frame with code 1008.
const std::string kPolicyError = "\x03\xf0";

TEST_F(FloodedWebSocketTest, EmptyFragmentsEndIt) {
  // The first fragment contains the kind of the message.
  const std::string begin = FrameOf(0x02, 1);
  std::string empty;
  for (int i = 0; i < 1000; ++i) empty += FrameOf(kContinuation, 0);
  EXPECT_NE(AnswerTo(begin + empty, 1).find(kPolicyError), std::string::npos);
}

TEST_F(FloodedWebSocketTest, PingsEndIt) {
  std::string pings;
  for (int i = 0; i < 1000; ++i) pings += FrameOf(kPing, 1);
  EXPECT_NE(AnswerTo(pings, 1).find(kPolicyError), std::string::npos);
}

TEST_F(FloodedWebSocketTest, AFewPingsDoNot) {
  std::string pings;
  for (int i = 0; i < 50; ++i) pings += FrameOf(kPing, 1);
  EXPECT_EQ(AnswerTo(pings, 1).find(kPolicyError), std::string::npos);
}

}  // namespace
}  // namespace thunderhead::gateway
