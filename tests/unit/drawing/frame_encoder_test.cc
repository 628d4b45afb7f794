// Tests of the encoder and the hub together: a picture is encoded and serialized once for all
// viewers who get it.
#include "drawing/frame_encoder.h"

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <semaphore>
#include <set>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::drawing {
namespace {

using ::testing::Pair;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

class SilentViewer : public delivery::Viewer {
 public:
  void Wake() override {}
};

class FrameEncoderTest : public ::testing::Test {
 protected:
  // Encodes a picture of 64 x 36 pixels and waits until it is published.
  void Encode(std::uint64_t revision) {
    DrawnFrame drawn;
    drawn.session = session_;
    drawn.scene_revision = revision;
    drawn.picture.width_px = 64;
    drawn.scene.output.width_px = 64;
    drawn.picture.height_px = 36;
    drawn.picture.rgb.assign(std::size_t{64} * 36 * 3, 100);
    encoder_.Encode(std::move(drawn));
    ASSERT_TRUE(encoded_.try_acquire_for(testing::kHangLimit));
  }

  // Adds `count` viewers, who take every frame.
  std::vector<std::uint64_t> Join(int count, const delivery::ViewerWants& wants) {
    std::vector<std::uint64_t> viewers;
    for (int i = 0; i < count; ++i) {
      viewers.push_back(*session_->hub().Join(std::make_shared<SilentViewer>(), wants));
    }
    return viewers;
  }

  // Returns the frames that the viewers take now. An object that several viewers share counts once.
  std::set<const delivery::EncodedFrame*> TakeAll(const std::vector<std::uint64_t>& viewers) {
    std::set<const delivery::EncodedFrame*> frames;
    for (const std::uint64_t viewer : viewers) {
      const auto event = session_->hub().Take(viewer);
      if (!event.has_value()) {
        ADD_FAILURE() << "a viewer has nothing to take";
        continue;
      }
      const auto frame = std::get<std::shared_ptr<const delivery::EncodedFrame>>(*event);
      session_->hub().Acknowledge(viewer, frame->sequence);
      kept_.push_back(frame);  // keeps other frames from reusing its address
      frames.insert(frame.get());
    }
    return frames;
  }

  std::map<std::string, int> Serialized() {
    const std::lock_guard lock(mutex_);
    return serialized_;
  }

  void FailNext(int serializations) {
    const std::lock_guard lock(mutex_);
    without_memory_ = serializations;
  }

  session::Sessions sessions_{session::SessionsOptions{}, {[] {}, [] {}}};
  const std::shared_ptr<session::Session> session_ = *sessions_.Create();
  const std::shared_ptr<base::MemoryBudget> memory_ =
      base::MemoryBudget::Make({.bytes = std::size_t{16} << 20});

 private:
  std::mutex mutex_;
  std::map<std::string, int> serialized_;  // number of serializations, by encoding and tier
  int without_memory_ = 0;  // number of the next serializations that fail for lack of memory
  std::vector<std::shared_ptr<const delivery::EncodedFrame>> kept_;
  std::counting_semaphore<> encoded_{0};

 protected:
  FrameEncoder encoder_{1,
                        [this](const delivery::EncodedFrame& frame) {
                          const std::string form = std::string(frame.vp9.empty() ? "jpeg" : "vp9") +
                                                   " of tier " + std::to_string(frame.tier);
                          const std::lock_guard lock(mutex_);
                          if (without_memory_-- > 0) throw std::bad_alloc();
                          ++serialized_[form];
                          return form;
                        },
                        memory_, [this] { encoded_.release(); }};
};

TEST_F(FrameEncoderTest, APictureIsSerializedOnceATierWhateverTheViewers) {
  const auto walls = Join(7, {});
  const auto phones = Join(5, {.window_width_px = 32});
  const auto watches = Join(3, {.window_width_px = 16});
  Encode(1);
  for (const auto& viewers : {walls, phones, watches}) EXPECT_EQ(TakeAll(viewers).size(), 1U);
  EXPECT_THAT(Serialized(),
              UnorderedElementsAre(Pair("jpeg of tier 0", 1), Pair("jpeg of tier 1", 1),
                                   Pair("jpeg of tier 2", 1)));
  // A viewer who joins later gets the same bytes.
  EXPECT_EQ(TakeAll(Join(4, {})).size(), 1U);
  EXPECT_EQ(Serialized().at("jpeg of tier 0"), 1);
  Encode(2);
  for (const auto& viewers : {walls, phones, watches}) EXPECT_EQ(TakeAll(viewers).size(), 1U);
  EXPECT_THAT(Serialized(),
              UnorderedElementsAre(Pair("jpeg of tier 0", 2), Pair("jpeg of tier 1", 2),
                                   Pair("jpeg of tier 2", 2)));
}

TEST_F(FrameEncoderTest, ATierThatNobodyWantsIsNotMade) {
  const auto phones = Join(5, {.window_width_px = 32});
  Encode(1);
  EXPECT_EQ(TakeAll(phones).size(), 1U);
  EXPECT_THAT(Serialized(), UnorderedElementsAre(Pair("jpeg of tier 1", 1)));
}

// Any number of pictures may fail, because none of them is in flight.
TEST_F(FrameEncoderTest, APictureWithoutMemoryFailsAlone) {
  const auto viewers = Join(1, {});
  for (std::uint64_t revision = 1; revision <= delivery::FrameHub::kMaxInFlight; ++revision) {
    FailNext(1000);
    Encode(revision);
    const auto event = session_->hub().Take(viewers.front());
    ASSERT_TRUE(event.has_value());
    const auto* const problem = std::get_if<delivery::Problem>(&*event);
    ASSERT_NE(problem, nullptr);
    EXPECT_EQ(problem->code, delivery::Problem::Code::kBusy);
    EXPECT_EQ(problem->scene_revision, revision);
  }
  FailNext(0);
  Encode(delivery::FrameHub::kMaxInFlight + 1);
  EXPECT_EQ(TakeAll(viewers).size(), 1U);
}

// A viewer that takes frames while it holds its own lock, like a gRPC call. If its own thread woke
// it meanwhile, it would deadlock.
class LockingViewer : public delivery::Viewer {
 public:
  void Wake() override {
    const std::unique_lock lock(mutex, std::try_to_lock);
    if (!lock.owns_lock()) woken_within_ = true;
  }
  bool woken_within() const { return woken_within_; }
  std::mutex mutex;

 private:
  bool woken_within_ = false;
};

TEST_F(FrameEncoderTest, NobodyIsWokenWithinTakingAPictureThatFails) {
  const auto viewer = std::make_shared<LockingViewer>();
  const std::uint64_t id = *session_->hub().Join(viewer);
  FailNext(1000);
  Encode(1);
  {
    const std::lock_guard lock(viewer->mutex);
    EXPECT_TRUE(session_->hub().Take(id).has_value());
  }
  EXPECT_FALSE(viewer->woken_within());
}

TEST_F(FrameEncoderTest, VideoWithoutMemoryIsJpeg) {
  const auto savers = Join(6, {.adapts = true, .takes_video = true, .saves_bytes = true});
  FailNext(1);
  Encode(1);
  EXPECT_EQ(TakeAll(savers).size(), 1U);
  EXPECT_THAT(Serialized(), UnorderedElementsAre(Pair(StartsWith("jpeg of tier"), 1)));
}

TEST_F(FrameEncoderTest, VideoWithoutRoomInTheBudgetIsJpeg) {
  const auto savers = Join(6, {.adapts = true, .takes_video = true, .saves_bytes = true});
  auto taken = *memory_->Reserve(base::MemoryUse::kFields, std::size_t{8} << 20, "fields");
  Encode(1);
  EXPECT_EQ(TakeAll(savers).size(), 1U);
  EXPECT_THAT(Serialized(), UnorderedElementsAre(Pair(StartsWith("jpeg of tier"), 1)));
  taken = {};
  Encode(2);
  EXPECT_EQ(TakeAll(savers).size(), 1U);
  EXPECT_THAT(Serialized(), ::testing::Contains(Pair("vp9 of tier 0", 1)));
  EXPECT_GT(memory_->Used(base::MemoryUse::kPictures), std::size_t{8} << 20);
  session_->video().Release();
  EXPECT_EQ(memory_->Used(), 0U);
}

TEST_F(FrameEncoderTest, APictureOfVideoIsSerializedOnceForAllWhoFollowIt) {
  const auto savers = Join(6, {.adapts = true, .takes_video = true, .saves_bytes = true});
  Encode(1);
  EXPECT_EQ(TakeAll(savers).size(), 1U);
  EXPECT_THAT(Serialized(), UnorderedElementsAre(Pair("vp9 of tier 0", 1)));
}

}  // namespace
}  // namespace thunderhead::drawing
