// Tests of video and of resting frames (AVIF of higher quality) in the frame hub. They check which
// encoding each viewer receives, key pictures, and viewers that miss pictures.
#include "delivery/frame_hub.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::delivery {
namespace {

using codec::Vp9Kind;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = FrameForm::Kind;

constexpr ViewerWants kVideo{
    .adapts = true, .takes_video = true, .takes_resting_frames = true, .saves_bytes = true};

class VideoViewer : public Viewer {
 public:
  void Wake() override { ++wakes; }
  int wakes = 0;
};

// A fixture with a hub whose video pictures are texts: "key", "base" or "droppable".
class VideoHubTest : public ::testing::Test {
 protected:
  std::uint64_t Join(const ViewerWants& wants) {
    return *hub_.Join(std::make_shared<VideoViewer>(), wants);
  }

  // Draws, encodes and publishes a frame, a thirtieth of a second after the previous one.
  std::uint64_t Publish(bool at_rest = false, bool resting_frame_follows = false) {
    now_ += milliseconds(33);
    EncodedFrame frame;
    frame.scene_revision = scene_revision_;
    frame.width_px = 1280;
    frame.at_rest = at_rest;
    if (by_reference_) frame.refinement.emplace();
    std::vector<EncodedVideo> video;
    for (VideoOrder order : hub_.OrderVideo(frame, resting_frame_follows, now_)) {
      if (resized_) order.kind = Vp9Kind::kKey;
      EncodedFrame picture = frame;
      picture.tier = order.tier;
      picture.key_frame = order.kind == Vp9Kind::kKey;
      picture.vp9 = order.kind == Vp9Kind::kKey    ? "key"
                    : order.kind == Vp9Kind::kBase ? "base"
                                                   : "droppable";
      video.push_back({order, std::move(picture)});
    }
    const auto jpeg = [](const EncodedFrame& described, int tier) {
      EncodedFrame encoded = described;
      encoded.jpeg = "jpeg";
      encoded.tier = tier;
      return std::optional(encoded);
    };
    return hub_.Publish(frame, jpeg, std::move(video), resting_frame_follows, now_);
  }

  void AddRestingFrame(std::uint64_t sequence, int tier = 0) {
    EncodedFrame resting_frame;
    resting_frame.avif = "avif";
    resting_frame.tier = tier;
    hub_.AddRestingFrame(sequence, tier, resting_frame);
  }

  // Takes the viewer's next picture and returns its kind, in whichever encoding, or "nothing".
  std::string Take(std::uint64_t viewer) {
    const auto event = hub_.Take(viewer, now_);
    if (!event.has_value()) return "nothing";
    const auto frame = std::get<std::shared_ptr<const EncodedFrame>>(*event);
    taken_ = frame->sequence;
    taken_tier_ = frame->tier;
    return frame->jpeg + frame->vp9 + frame->avif;
  }

  std::string TakeAndAcknowledge(std::uint64_t viewer) {
    const std::string taken = Take(viewer);
    if (taken != "nothing") hub_.Acknowledge(viewer, taken_, now_ + milliseconds(5));
    return taken;
  }

  FrameHub hub_{[] {}};
  FrameHub::Time now_ = FrameHub::Time() + std::chrono::hours(1);
  std::uint64_t taken_ = 0;
  int taken_tier_ = 0;
  std::uint64_t scene_revision_ = 1;
  bool by_reference_ = false;
  // If true, Publish makes a key picture even if none is requested, as the encoders do after a
  // change of size.
  bool resized_ = false;
};

TEST_F(VideoHubTest, ANewcomerGetsAKeyPictureFirst) {
  const auto first = Join(kVideo);
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(first), "key");
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(first), "base");
  const auto newcomer = Join(kVideo);
  EXPECT_EQ(TakeAndAcknowledge(newcomer), "jpeg") << "until the next key picture";
  std::string seen;
  for (int i = 0; i < 40 && seen != "key"; ++i) {
    Publish();
    TakeAndAcknowledge(first);
    seen = TakeAndAcknowledge(newcomer);
    EXPECT_TRUE(seen == "key" || seen == "jpeg") << seen;
  }
  EXPECT_EQ(seen, "key");
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(newcomer), "base");
}

TEST_F(VideoHubTest, AKeyPictureThatNobodyAskedForThrowsNobodyOut) {
  const auto quick = Join(kVideo);
  const auto slow = Join(kVideo);
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(quick), "key");
  EXPECT_EQ(TakeAndAcknowledge(slow), "key");
  resized_ = true;
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(quick), "key");
  resized_ = false;
  Publish();
  EXPECT_NE(TakeAndAcknowledge(quick), "jpeg");
  EXPECT_EQ(TakeAndAcknowledge(slow), "key") << "which it has missed, and can take all the same";
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(slow), "base");
}

TEST_F(VideoHubTest, ManyNewcomersDoNotMakeManyKeyPictures) {
  const auto first = Join(kVideo);
  int keys = 0;
  for (int i = 0; i < 90; ++i) {
    Join(kVideo);
    Publish();
    keys += TakeAndAcknowledge(first) == "key" ? 1 : 0;
  }
  EXPECT_LE(keys, 4) << "in three seconds";
}

TEST_F(VideoHubTest, WhoDecodesNoVideoNeverGetsIt) {
  const auto video = Join(kVideo);
  const auto old = Join({});
  const auto jpeg = Join({.adapts = true, .saves_bytes = true});
  for (int i = 0; i < 30; ++i) {
    Publish();
    TakeAndAcknowledge(video);
    EXPECT_EQ(TakeAndAcknowledge(old), "jpeg");
    EXPECT_EQ(TakeAndAcknowledge(jpeg), "jpeg");
  }
}

TEST_F(VideoHubTest, AFastLinkGetsJpegAndASlowOneVideo) {
  ViewerWants wants = kVideo;
  wants.saves_bytes = false;
  const auto fast = Join(wants);
  const auto slow = Join(wants);
  std::string seen;
  for (int i = 0; i < 60; ++i) {
    Publish();
    EXPECT_EQ(TakeAndAcknowledge(fast), "jpeg");
    seen = Take(slow);
    now_ += milliseconds(seen == "jpeg" ? 400 : 10);
    hub_.Acknowledge(slow, taken_, now_);
  }
  EXPECT_NE(seen, "jpeg");
  EXPECT_NE(seen, "nothing");
}

TEST_F(VideoHubTest, WhoWasSentJpegForAWhileJoinsTheVideoAnewAtOnce) {
  const auto viewer = Join(kVideo);
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(viewer), "key");
  Publish();  // a base picture, which the viewer does not take before the next
  ViewerWants jpeg = kVideo;
  jpeg.takes_video = false;
  hub_.SetWants(viewer, jpeg);
  for (int i = 0; i < 40; ++i) {
    Publish();
    EXPECT_EQ(TakeAndAcknowledge(viewer), "jpeg");
  }
  hub_.SetWants(viewer, kVideo);
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(viewer), "key");
}

TEST_F(VideoHubTest, NobodyWaitsForABasePictureThatANewerOneHasReplaced) {
  VideoStream stream;
  VideoPlace place;
  const auto next = [&](bool is_ready, std::uint64_t last_sequence) {
    now_ += milliseconds(33);
    stream.Begin();
    stream.Ask(0, {&place, is_ready, last_sequence}, now_);
    return stream.Next(now_);
  };
  EXPECT_EQ(next(true, 0), Vp9Kind::kKey);
  place.Took(1, stream.Add(1, Vp9Kind::kKey, std::make_shared<EncodedFrame>(), now_), now_);
  EXPECT_EQ(next(true, 1), Vp9Kind::kBase);
  stream.Add(2, Vp9Kind::kBase, std::make_shared<EncodedFrame>(), now_);
  EXPECT_EQ(next(true, 1), std::nullopt) << "it can still take the base picture";
  now_ += VideoPlace::kLongestWait;
  next(true, 3);
  now_ += VideoPlace::kLongestWait;
  EXPECT_EQ(next(true, 3), Vp9Kind::kKey) << "it has JPEG of a newer frame";
}

TEST_F(VideoHubTest, ManyWhoCanAllGetVideo) {
  ViewerWants wants = kVideo;
  wants.saves_bytes = false;
  std::vector<std::uint64_t> viewers;
  for (int i = 1; i < FrameHub::kManyForVideo; ++i) viewers.push_back(Join(wants));
  Publish();
  EXPECT_EQ(Take(viewers.front()), "jpeg");
  viewers.push_back(Join(wants));
  Publish();
  for (const auto viewer : viewers) EXPECT_EQ(Take(viewer), "key");
}

// The slow viewer misses pictures, but gets those on which later pictures depend. The fast viewer
// gets all pictures.
TEST_F(VideoHubTest, ASlowViewerMissesDroppablePicturesOnlyAndForcesNoKeys) {
  const auto fast = Join(kVideo);
  const auto slow = Join(kVideo);
  int keys = 0;
  int taken_by_slow = 0;
  for (int i = 0; i < 120; ++i) {
    Publish();
    const std::string seen = TakeAndAcknowledge(fast);
    EXPECT_NE(seen, "nothing");
    EXPECT_NE(seen, "jpeg");
    keys += seen == "key" ? 1 : 0;
    // The slow viewer may have two pictures in flight; one of them arrives every second picture.
    const std::string of_slow = Take(slow);
    EXPECT_NE(of_slow, "jpeg");
    taken_by_slow += of_slow == "nothing" ? 0 : 1;
    if (i % 2 == 1) hub_.Acknowledge(slow, taken_ > 1 ? taken_ - 1 : 1, now_ + milliseconds(300));
  }
  EXPECT_EQ(keys, 1);
  EXPECT_GE(taken_by_slow, 40);
}

TEST_F(VideoHubTest, WhoStallsDoesNotHoldUpTheOthersNorAskForKeys) {
  const auto fast = Join(kVideo);
  const auto stalled = Join(kVideo);
  int keys = 0;
  for (int i = 0; i < 200; ++i) {
    Publish();
    keys += TakeAndAcknowledge(fast) == "key" ? 1 : 0;
    Take(stalled);
  }
  EXPECT_EQ(keys, 1);
}

TEST_F(VideoHubTest, WhoLosesVideoGetsJpegAndAKeyPictureLaterEachTime) {
  const auto viewer = Join(kVideo);
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(viewer), "key");
  std::vector<int> waits;
  for (int loss = 0; loss < 3; ++loss) {
    hub_.LoseVideo(viewer, now_);
    int pictures = 0;
    std::string seen = "jpeg";
    for (; seen == "jpeg" && pictures < 3000; ++pictures) {
      Publish();
      seen = TakeAndAcknowledge(viewer);
    }
    EXPECT_EQ(seen, "key");
    waits.push_back(pictures);
  }
  EXPECT_GE(waits[0], 60);
  EXPECT_GE(waits[1], 2 * waits[0] - 10);
  EXPECT_GE(waits[2], 2 * waits[1] - 10);
}

TEST_F(VideoHubTest, AtRestTheRestingFrameReplacesVideoAndComesOnce) {
  const auto video = Join(kVideo);
  const auto jpeg = Join({.adapts = true});
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(video), "key");
  EXPECT_EQ(TakeAndAcknowledge(jpeg), "jpeg");
  const std::uint64_t sequence = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(TakeAndAcknowledge(video), "base") << "at once, before the resting frame is encoded";
  EXPECT_EQ(TakeAndAcknowledge(jpeg), "jpeg");
  EXPECT_EQ(Take(video), "nothing");
  AddRestingFrame(sequence);
  EXPECT_EQ(TakeAndAcknowledge(video), "avif");
  EXPECT_EQ(Take(video), "nothing");
  EXPECT_EQ(Take(jpeg), "nothing");
  // The video stream continues.
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(video), "base");
}

// A resting frame may be replaced when the path-traced correction has improved, or when the error
// is known.
TEST_F(VideoHubTest, ARestingFrameIsReplacedByNothingButTheNextOneOfItsScene) {
  const auto video = Join(kVideo);
  const auto resting = Join({.takes_resting_frames = true});
  const auto jpeg = Join({});
  const auto settle = [&] {
    const std::uint64_t sequence = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
    for (const std::uint64_t viewer : {video, resting, jpeg}) TakeAndAcknowledge(viewer);
    AddRestingFrame(sequence);
    EXPECT_EQ(TakeAndAcknowledge(video), "avif");
    EXPECT_EQ(TakeAndAcknowledge(resting), "avif");
    EXPECT_EQ(Take(jpeg), "nothing");
  };
  Publish();
  EXPECT_EQ(TakeAndAcknowledge(video), "key");
  settle();
  for (int i = 0; i < 5; ++i) {
    Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
    EXPECT_EQ(Take(video), "nothing");
    EXPECT_EQ(Take(resting), "nothing");
    EXPECT_EQ(TakeAndAcknowledge(jpeg), "jpeg");
  }
  settle();
  const std::uint64_t last = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(Take(resting), "nothing");
  hub_.NoRestingFrame(last);
  EXPECT_EQ(TakeAndAcknowledge(resting), "jpeg") << "there is nothing better";
  settle();
  // On a very busy machine, each frame supersedes the previous resting frame.
  for (int i = 0; i < 5; ++i) {
    now_ += seconds(1);
    Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
    TakeAndAcknowledge(video);
    EXPECT_EQ(TakeAndAcknowledge(resting), i < 2 ? "nothing" : "jpeg") << i;
  }
  settle();
  by_reference_ = true;
  Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(TakeAndAcknowledge(resting), "jpeg") << "its pictures come too fast to wait";
  EXPECT_EQ(TakeAndAcknowledge(video), "base");
  by_reference_ = false;
  settle();
  ++scene_revision_;
  Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(TakeAndAcknowledge(resting), "jpeg");
  EXPECT_EQ(TakeAndAcknowledge(video), "base") << "the stream goes on";
}

// The resting frame was encoded for the smaller window. The larger picture is more valuable than
// the better encoding.
TEST_F(VideoHubTest, AWindowThatGrowsAtRestGetsTheLargerPicture) {
  ViewerWants wants{.window_width_px = 640, .adapts = true, .takes_resting_frames = true};
  const auto viewer = Join(wants);
  const std::uint64_t sequence = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "jpeg");
  AddRestingFrame(sequence, 1);
  hub_.NoRestingFrame(sequence);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "avif");
  EXPECT_EQ(taken_tier_, 1);
  wants.window_width_px = 600;
  hub_.SetWants(viewer, wants);
  EXPECT_EQ(Take(viewer), "nothing") << "it fills the window";
  wants.window_width_px = 1280;
  hub_.SetWants(viewer, wants);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "jpeg");
  EXPECT_EQ(taken_tier_, 0);
  EXPECT_EQ(Take(viewer), "nothing");
}

TEST_F(VideoHubTest, WithoutARestingFrameJpegReplacesVideo) {
  const auto viewer = Join(kVideo);
  const std::uint64_t sequence = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "key");
  hub_.NoRestingFrame(sequence);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "jpeg");
}

TEST_F(VideoHubTest, AFrameDrawnInMotionIsSentInFullOnceItRests) {
  ViewerWants wants = kVideo;
  wants.takes_resting_frames = false;
  const auto viewer = Join(wants);
  const std::uint64_t sequence = Publish();
  EXPECT_EQ(TakeAndAcknowledge(viewer), "key");
  EXPECT_EQ(Take(viewer), "nothing");
  hub_.Rest(sequence);
  EXPECT_EQ(TakeAndAcknowledge(viewer), "jpeg");
}

TEST_F(VideoHubTest, ARestingFrameOfAnOlderFrameIsDropped) {
  const auto viewer = Join(kVideo);
  const std::uint64_t older = Publish(/*at_rest=*/true, /*resting_frame_follows=*/true);
  TakeAndAcknowledge(viewer);
  Publish();
  AddRestingFrame(older);
  EXPECT_EQ(Take(viewer), "base");
}

TEST(FlightWindowTest, GrowsOnAFarLinkAndShrinksOnAFullOne) {
  FlightWindow window;
  for (int i = 0; i < 20; ++i) window.Acknowledged(milliseconds(150), /*was_full=*/true);
  EXPECT_EQ(window.size(), FlightWindow::kMax);
  for (int i = 0; i < 20; ++i) window.Acknowledged(milliseconds(600), /*was_full=*/true);
  EXPECT_EQ(window.size(), FlightWindow::kLeast);
}

TEST(FlightWindowTest, DoesNotGrowUnused) {
  FlightWindow window;
  for (int i = 0; i < 20; ++i) window.Acknowledged(milliseconds(150), /*was_full=*/false);
  EXPECT_EQ(window.size(), FlightWindow::kLeast);
}

}  // namespace
}  // namespace thunderhead::delivery
