// The hub alone: in flight, skipping, problems, closing.
#include "session/frame_hub.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::session {
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

// The sequence of the frame taken, or 0.
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
  hub_.Acknowledge(id, 1);
  EXPECT_EQ(viewer->wakes, 2);
  EXPECT_EQ(demands_, 2);
  hub_.Leave(id);
  hub_.Publish(FrameOf(2));
  EXPECT_EQ(viewer->wakes, 2);
  EXPECT_FALSE(hub_.HasViewers());
  EXPECT_FALSE(hub_.Acknowledge(id, 2));
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

}  // namespace
}  // namespace thunderhead::session
