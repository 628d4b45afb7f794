// Tests of choosing the picture size that suits a link, on simulated links.
#include "delivery/link_estimate.h"

#include <algorithm>

#include "gtest/gtest.h"

namespace thunderhead::delivery {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = LinkEstimate::Time;

// A simulated network link that carries frames one after another. As in the frame hub, two frames
// may be in flight.
class Link {
 public:
  Link(double kbit_per_s, milliseconds round_trip)
      : kbit_per_s_(kbit_per_s), round_trip_(round_trip) {}

  // Sends frames of `full_kbyte` at tier 0 for `duration`, a new one every `frame_interval`.
  // Returns the frames per second that arrived.
  double Run(seconds duration, double full_kbyte, milliseconds frame_interval = milliseconds(33)) {
    const Time end = now_ + duration;
    int arrived = 0;
    Time in_flight_acknowledged[2] = {now_, now_};
    while (now_ < end) {
      // The older of two acknowledgements permits the next frame.
      Time& oldest =
          *std::min_element(std::begin(in_flight_acknowledged), std::end(in_flight_acknowledged));
      now_ = std::max(now_ + frame_interval, oldest);
      const Time sent_at = now_;
      double kbyte = full_kbyte;
      for (int tier = 0; tier < estimate.step(); ++tier) kbyte /= 3.0;
      const milliseconds transfer(static_cast<int>(kbyte * 8.0 / kbit_per_s_ * 1000.0));
      free_at_ = std::max(free_at_, sent_at) + transfer;
      const Time acknowledged = free_at_ + round_trip_;
      oldest = acknowledged;
      pending_.push_back({sent_at, acknowledged});
      while (!pending_.empty() && pending_.front().second <= now_) Deliver(&arrived);
    }
    while (!pending_.empty()) Deliver(&arrived);
    return arrived / std::chrono::duration<double>(duration).count();
  }

  void SetSpeed(double kbit_per_s) { kbit_per_s_ = kbit_per_s; }

  LinkEstimate estimate;

 private:
  void Deliver(int* arrived) {
    estimate.Acknowledged(pending_.front().second, pending_.front().first);
    pending_.erase(pending_.begin());
    ++*arrived;
  }

  double kbit_per_s_;
  milliseconds round_trip_;
  Time now_ = Time() + seconds(100);
  Time free_at_;
  std::vector<std::pair<Time, Time>> pending_;
};

TEST(LinkEstimateTest, AFastLinkGetsFullPictures) {
  Link link(100'000, milliseconds(2));
  EXPECT_GT(link.Run(seconds(20), 45), 25.0);
  EXPECT_EQ(link.estimate.step(), 0);
}

TEST(LinkEstimateTest, AFarButFastLinkGetsFullPictures) {
  Link link(100'000, milliseconds(300));
  link.Run(seconds(20), 45);
  EXPECT_EQ(link.estimate.step(), 0) << "distance is not slowness";
}

TEST(LinkEstimateTest, ASlowLinkGetsSmallerPicturesAndEnoughOfThem) {
  Link link(1'000, milliseconds(150));
  link.Run(seconds(10), 45);
  EXPECT_GE(link.estimate.step(), 1);
  EXPECT_GT(link.Run(seconds(30), 45), 8.0);
}

TEST(LinkEstimateTest, AMiddlingLinkDoesNotFlap) {
  Link link(2'500, milliseconds(40));
  link.Run(seconds(30), 45);
  int changes = 0;
  int tier = link.estimate.step();
  for (int i = 0; i < 60; ++i) {
    link.Run(seconds(1), 45);
    changes += link.estimate.step() == tier ? 0 : 1;
    tier = link.estimate.step();
  }
  EXPECT_LE(changes, 6);
}

TEST(LinkEstimateTest, ALinkThatRecoversGetsFullPicturesAgain) {
  Link link(800, milliseconds(20));
  link.Run(seconds(10), 45);
  ASSERT_GE(link.estimate.step(), 1);
  link.SetSpeed(50'000);
  link.Run(seconds(40), 45);
  EXPECT_EQ(link.estimate.step(), 0);
}

TEST(LinkEstimateTest, WindowsGetTheSmallestPictureThatFillsThem) {
  EXPECT_EQ(TierForWindow({1280, 1280}, 0), 0);
  EXPECT_EQ(TierForWindow({1280, 1280}, 1280), 0);
  EXPECT_EQ(TierForWindow({1280, 1280}, 641), 0);
  EXPECT_EQ(TierForWindow({1280, 1280}, 640), 1);
  EXPECT_EQ(TierForWindow({1280, 1280}, 100), 2);
  // Moving pictures may be narrower than at rest: here they are 0.84, 0.5 and 0.2 times as wide.
  // The last one is so narrow that it is reduced less than the picture at rest.
  EXPECT_EQ(TierForWindow({1076, 1280}, 640), 1);
  EXPECT_EQ(TierForWindow({640, 1280}, 640), 1);
  EXPECT_EQ(TierForWindow({640, 1280}, 1280), 0);
  EXPECT_EQ(TierForWindow({1697, 8192}, 1280), 1);
}

}  // namespace
}  // namespace thunderhead::delivery
