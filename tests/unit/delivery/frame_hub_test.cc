// Tests of the frame hub, which gives frames to viewers: frames in flight, skipped frames, problems
// and closing.
#include "delivery/frame_hub.h"

#include <array>

#include "base/error_details.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "telemetry/metrics.h"

namespace thunderhead::delivery {
namespace {

class CountingViewer : public Viewer {
 public:
  void Wake() override { ++wakes; }
  int wakes = 0;
};

EncodedFrame FrameOf(std::uint64_t revision) {
  EncodedFrame frame;
  frame.scene_revision = revision;
  return frame;
}

// Takes the viewer's next frame and returns its sequence number; 0 if there is no frame.
std::uint64_t TakeSequence(FrameHub& hub, std::uint64_t viewer_id) {
  const auto event = hub.Take(viewer_id);
  if (!event.has_value()) return 0;
  const auto* frame = std::get_if<std::shared_ptr<const EncodedFrame>>(&*event);
  return frame == nullptr ? 0 : (*frame)->sequence;
}

class FrameHubTest : public ::testing::Test {
 protected:
  std::uint64_t Join() { return *hub_.Join(std::make_shared<CountingViewer>()); }

  int demands_ = 0;
  FrameHub hub_{[this] { ++demands_; }};
};

TEST_F(FrameHubTest, AtMostTwoFramesAreInFlight) {
  const std::uint64_t viewer = Join();
  hub_.Publish(FrameOf(1));
  EXPECT_EQ(TakeSequence(hub_, viewer), 1U);
  EXPECT_TRUE(hub_.HasReadyViewer());
  hub_.Publish(FrameOf(2));
  EXPECT_EQ(TakeSequence(hub_, viewer), 2U);
  EXPECT_FALSE(hub_.HasReadyViewer());
  hub_.Publish(FrameOf(3));
  EXPECT_EQ(TakeSequence(hub_, viewer), 0U);
  EXPECT_TRUE(hub_.Acknowledge(viewer, 1));
  EXPECT_EQ(TakeSequence(hub_, viewer), 3U);
}

TEST_F(FrameHubTest, AFrameIsGivenUpOnlyIfNobodyWatches) {
  const std::uint64_t viewer = Join();
  EXPECT_FALSE(hub_.DropUnwatched()) << "there is none";
  hub_.Publish(FrameOf(1));
  EXPECT_FALSE(hub_.DropUnwatched());
  hub_.Leave(viewer);
  EXPECT_TRUE(hub_.DropUnwatched());
  const std::uint64_t another = Join();
  EXPECT_EQ(TakeSequence(hub_, another), 0U);
  hub_.Publish(FrameOf(1));
  EXPECT_EQ(TakeSequence(hub_, another), 2U);
}

TEST_F(FrameHubTest, SlowViewerSkipsAndTheFastOneDoesNotWait) {
  const std::uint64_t slow = Join();
  const std::uint64_t fast = Join();
  for (std::uint64_t sequence = 1; sequence <= 10; ++sequence) {
    hub_.Publish(FrameOf(sequence));
    EXPECT_EQ(TakeSequence(hub_, fast), sequence);
    hub_.Acknowledge(fast, sequence);
    TakeSequence(hub_, slow);
  }
  hub_.Acknowledge(slow, 2);
  EXPECT_EQ(TakeSequence(hub_, slow), 10U);
}

TEST_F(FrameHubTest, AFrameIsTakenOnce) {
  const std::uint64_t viewer = Join();
  hub_.Publish(FrameOf(1));
  EXPECT_EQ(TakeSequence(hub_, viewer), 1U);
  EXPECT_EQ(TakeSequence(hub_, viewer), 0U);
}

TEST_F(FrameHubTest, LateViewerGetsTheNewestFrame) {
  hub_.Publish(FrameOf(1));
  hub_.Publish(FrameOf(2));
  EXPECT_EQ(TakeSequence(hub_, Join()), 2U);
}

TEST_F(FrameHubTest, ProblemIsToldOnceToEachAndDoesNotCountAsInFlight) {
  const std::uint64_t viewer = Join();
  hub_.Publish(FrameOf(1));
  TakeSequence(hub_, viewer);
  hub_.Publish(FrameOf(2));
  TakeSequence(hub_, viewer);
  hub_.Publish(Problem{3, "no such weather"});
  const auto event = hub_.Take(viewer);
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(std::get<Problem>(*event).message, "no such weather");
  EXPECT_FALSE(hub_.Take(viewer).has_value());
  const std::uint64_t late = Join();
  EXPECT_EQ(TakeSequence(hub_, late), 2U);
  EXPECT_EQ(std::get<Problem>(*hub_.Take(late)).scene_revision, 3U);
}

TEST_F(FrameHubTest, OnlyAFrameAsNewAsTheProblemEndsIt) {
  hub_.Publish(Problem{3, "unreadable"});
  hub_.Publish(FrameOf(2));
  const std::uint64_t early = Join();
  EXPECT_EQ(TakeSequence(hub_, early), 1U);
  EXPECT_TRUE(hub_.Take(early).has_value());
  hub_.Publish(FrameOf(3));
  const std::uint64_t late = Join();
  EXPECT_EQ(TakeSequence(hub_, late), 2U);
  EXPECT_FALSE(hub_.Take(late).has_value());
}

TEST_F(FrameHubTest, ViewersAreWokenAndDemandIsTold) {
  const auto viewer = std::make_shared<CountingViewer>();
  const std::uint64_t id = *hub_.Join(viewer);
  EXPECT_EQ(demands_, 1);
  hub_.Publish(FrameOf(1));
  EXPECT_EQ(viewer->wakes, 1);
  hub_.Take(id);
  hub_.Acknowledge(id, 1);
  EXPECT_EQ(viewer->wakes, 1) << "there is nothing to take";
  EXPECT_EQ(demands_, 1) << "it was ready before";
  hub_.Publish(FrameOf(2));
  hub_.Take(id);
  hub_.Publish(FrameOf(3));
  hub_.Take(id);
  hub_.Publish(FrameOf(4));
  EXPECT_EQ(viewer->wakes, 4);
  hub_.Acknowledge(id, 2);
  EXPECT_EQ(viewer->wakes, 5) << "there is a newer frame to take";
  EXPECT_EQ(demands_, 2) << "it became ready";
  hub_.Leave(id);
  hub_.Publish(FrameOf(5));
  EXPECT_EQ(viewer->wakes, 5);
  EXPECT_FALSE(hub_.HasViewers());
  EXPECT_FALSE(hub_.Acknowledge(id, 2));
}

using Made =
    std::array<int, kTiers>;  // number of frames made for each tier (level of size reduction)

// Returns a function that counts the frames it makes.
EncodeFrame CountingReduction(Made* made) {
  return [made](const EncodedFrame& described, int tier) {
    ++(*made)[static_cast<std::size_t>(tier)];
    EncodedFrame encoded = described;
    encoded.tier = tier;
    return encoded;
  };
}

int TakeTier(FrameHub& hub, std::uint64_t viewer_id, FrameHub::Time now) {
  const auto event = hub.Take(viewer_id, now);
  if (!event.has_value()) return -1;
  return std::get<std::shared_ptr<const EncodedFrame>>(*event)->tier;
}

TEST_F(FrameHubTest, ASizeIsMadeOnceForAllWhoWantIt) {
  EncodedFrame frame = FrameOf(1);
  frame.width_px = 1280;
  const auto now = FrameHub::Time() + std::chrono::hours(1);
  std::vector<std::uint64_t> phones;
  for (int i = 0; i < 5; ++i) {
    phones.push_back(*hub_.Join(std::make_shared<CountingViewer>(), {.window_width_px = 400}));
  }
  std::vector<std::uint64_t> walls;
  for (int i = 0; i < 5; ++i) walls.push_back(Join());
  const Made once{1, 1, 0};
  Made made{};
  hub_.Publish(frame, CountingReduction(&made));
  EXPECT_EQ(made, once) << "before anybody waits for it";
  for (const std::uint64_t phone : phones) EXPECT_EQ(TakeTier(hub_, phone, now), 1);
  for (const std::uint64_t wall : walls) EXPECT_EQ(TakeTier(hub_, wall, now), 0);
  EXPECT_EQ(made, once);
  // When a window grows, its viewer gets the same frame in a larger size.
  hub_.SetWants(phones[0], {.window_width_px = 1280});
  EXPECT_EQ(TakeTier(hub_, phones[0], now), 0);
  EXPECT_EQ(made, once) << "it was made for others";
}

TEST_F(FrameHubTest, ASlowLinkGetsSmallMovingPicturesAndFullRestingFrames) {
  const std::uint64_t viewer = *hub_.Join(std::make_shared<CountingViewer>(), {.adapts = true});
  const std::uint64_t other = Join();
  auto now = FrameHub::Time() + std::chrono::hours(1);
  Made made{};
  int tier = 0;
  for (int i = 0; i < 20; ++i) {
    hub_.Publish(FrameOf(1), CountingReduction(&made));
    const auto event = hub_.Take(viewer, now);
    const auto frame = std::get<std::shared_ptr<const EncodedFrame>>(*event);
    tier = frame->tier;
    EXPECT_EQ(TakeTier(hub_, other, now), 0);
    now += std::chrono::milliseconds(tier == 0 ? 400 : 60);
    hub_.Acknowledge(viewer, frame->sequence, now);
    hub_.Acknowledge(other, frame->sequence, now);
  }
  EXPECT_EQ(tier, 1);
  EncodedFrame resting = FrameOf(2);
  resting.at_rest = true;
  hub_.Publish(resting, CountingReduction(&made));
  EXPECT_EQ(TakeTier(hub_, viewer, now), 0);
}

TEST_F(FrameHubTest, WhoWantsFewFramesWaitsAndIsWoken) {
  const auto viewer = std::make_shared<CountingViewer>();
  const std::uint64_t id = *hub_.Join(viewer, {.frames_per_second = 10.0});
  const auto start = FrameHub::Time() + std::chrono::hours(1);
  hub_.Publish(FrameOf(1));
  EXPECT_EQ(TakeTier(hub_, id, start), 0);
  hub_.Publish(FrameOf(2));
  const auto soon = start + std::chrono::milliseconds(50);
  EXPECT_EQ(TakeTier(hub_, id, soon), -1);
  EXPECT_EQ(hub_.WakeWaiting(soon), start + std::chrono::milliseconds(100));
  const int wakes = viewer->wakes;
  EXPECT_EQ(hub_.WakeWaiting(start + std::chrono::milliseconds(100)), std::nullopt);
  EXPECT_EQ(viewer->wakes, wakes + 1);
  EXPECT_EQ(TakeTier(hub_, id, start + std::chrono::milliseconds(100)), 0);
}

TEST_F(FrameHubTest, ClosingWakesAndRefuses) {
  const auto viewer = std::make_shared<CountingViewer>();
  const std::uint64_t id = *hub_.Join(viewer);
  hub_.Publish(FrameOf(1));
  hub_.Close(absl::NotFoundError("closed"));
  hub_.Close(absl::UnavailableError("later"));
  EXPECT_EQ(viewer->wakes, 2);
  EXPECT_FALSE(hub_.Take(id).has_value());
  EXPECT_EQ(hub_.ClosedBecause().message(), "closed");
  EXPECT_EQ(hub_.Join(viewer).status().code(), absl::StatusCode::kNotFound);
}

TEST(Problems, AreCountedAsRefusals) {
  telemetry::Counter& counted = telemetry::Counted().refusals.Of("MEMORY_BUDGET");
  const std::uint64_t before = counted.Value();
  const absl::Status full = base::WithDetails(absl::ResourceExhaustedError("no memory is left"),
                                              {.reason = "MEMORY_BUDGET"});
  EXPECT_EQ(ProblemOf(1, full).code, Problem::Code::kBusy);
  EXPECT_EQ(UnreadableStorm(1, full).code, Problem::Code::kBusy);
  EXPECT_EQ(counted.Value(), before + 2);
}

}  // namespace
}  // namespace thunderhead::delivery
