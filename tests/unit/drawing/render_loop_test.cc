// Tests of the render loop with its reader and encoder, without gRPC, so that ThreadSanitizer sees
// every lock.
#include "drawing/render_loop.h"

#include <algorithm>
#include <future>
#include <mutex>

#include "base/error_details.h"
#include "base/memory_budget.h"
#include "drawing/device_losses.h"
#include "drawing/image_drawer.h"
#include "gl/device_faults.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "telemetry/metrics.h"
#include "tests/service/fake_engine.h"
#include "tests/support/manual_time.h"
#include "tests/support/techniques.h"
#include "tests/support/wait_for.h"

namespace thunderhead::drawing {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::FakeMachine;
using testing::FakeStormStore;
using ::testing::HasSubstr;
using testing::WaitFor;

scene::Scene Small(double sun_azimuth_deg) {
  scene::Scene scene = test_support::PlainScene();
  scene.storm_id = "anvil";
  scene.output = {64, 36, 88};
  scene::SetSlices(&scene.rendering.technique, 16);
  scene.sun.azimuth_deg = sun_azimuth_deg;
  return scene;
}

// A viewer that takes and acknowledges every event at once.
class EagerViewer : public delivery::Viewer, public std::enable_shared_from_this<EagerViewer> {
 public:
  explicit EagerViewer(std::shared_ptr<session::Session> session) : session_(std::move(session)) {}

  void Join() {
    id_ = *session_->hub().Join(shared_from_this());
    Wake();
  }
  void Leave() { session_->hub().Leave(id_); }
  // Releases the frames.
  void Forget() {
    const std::lock_guard lock(mutex_);
    events_.clear();
  }

  void Wake() override {
    if (id_ == 0) return;
    const auto event = session_->hub().Take(id_);
    if (!event.has_value()) return;
    std::uint64_t sequence = 0;
    {
      const std::lock_guard lock(mutex_);
      events_.push_back(*event);
      if (const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&*event)) {
        sequence = (*frame)->sequence;
      }
    }
    changed_.notify_all();
    // Acknowledging wakes the viewer again.
    session_->hub().Acknowledge(id_, sequence);
  }

  bool Await(std::uint64_t revision, bool refined) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, testing::kPatience, [&] {
      return std::any_of(events_.begin(), events_.end(), [&](const delivery::FrameEvent& event) {
        const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&event);
        return frame != nullptr && (*frame)->scene_revision >= revision &&
               ((*frame)->refined || !refined);
      });
    });
  }

  // Returns true if there was a frame of at least that revision for which `is` returns true.
  template <typename Is>
  bool Has(std::uint64_t revision, const Is& is) {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(events_, [&](const delivery::FrameEvent& event) {
      const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&event);
      return frame != nullptr && (*frame)->scene_revision >= revision && is(**frame);
    });
  }

  bool AwaitProblem(const std::string& message) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, testing::kPatience, [&] {
      return std::any_of(events_.begin(), events_.end(), [&](const delivery::FrameEvent& event) {
        const auto* problem = std::get_if<delivery::Problem>(&event);
        return problem != nullptr && problem->message == message;
      });
    });
  }

  // Waits for the newest frame that reports the path-traced correction as not shown.
  std::shared_ptr<const delivery::EncodedFrame> AwaitUntraced() {
    std::unique_lock lock(mutex_);
    std::shared_ptr<const delivery::EncodedFrame> untraced;
    changed_.wait_for(lock, testing::kPatience, [&] {
      for (const delivery::FrameEvent& event : events_) {
        const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&event);
        if (frame == nullptr || (*frame)->modelled.content.not_shown.empty()) continue;
        untraced = *frame;
      }
      return untraced != nullptr;
    });
    return untraced;
  }

  std::size_t ProblemCount() {
    const std::lock_guard lock(mutex_);
    return static_cast<std::size_t>(
        std::ranges::count_if(events_, [](const delivery::FrameEvent& event) {
          return std::holds_alternative<delivery::Problem>(event);
        }));
  }

  std::size_t EventCount() {
    const std::lock_guard lock(mutex_);
    return events_.size();
  }

 private:
  const std::shared_ptr<session::Session> session_;
  std::atomic<std::uint64_t> id_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<delivery::FrameEvent> events_;
};

// A fixture with a fake clock, which advances when the fake machine draws and when a test advances
// it.
class RenderLoopTest : public ::testing::Test {
 protected:
  RenderLoopTest() { machine_->time = &time_; }
  ~RenderLoopTest() override {
    machine_->opening.Open();
    machine_->drawing.Open();
    machine_->next_piece.Open();
    machine_->preparing.Open();
    machine_->tracing.Open();
    store_.reading.Open();
    loop_.reset();
    // A session keeps its viewers and they keep the session, so they must leave.
    for (const auto& viewer : viewers_) viewer->Leave();
  }

  void Start(const RenderLoopOptions& options = {}) {
    auto loop =
        RenderLoop::Start(options, store_, sessions_, wake_, testing::FakeFrameSources(machine_));
    ASSERT_TRUE(loop.ok()) << loop.status();
    loop_ = *std::move(loop);
  }

  std::shared_ptr<EagerViewer> Watch(const std::shared_ptr<session::Session>& session) {
    auto viewer = std::make_shared<EagerViewer>(session);
    viewer->Join();
    const std::lock_guard lock(viewers_mutex_);
    viewers_.push_back(viewer);
    return viewer;
  }

  static scene::Scene OfMetaballs(int count, int time_index = 0) {
    scene::Scene scene = Small(0.0);
    scene.time_index = time_index;
    test_support::SetTechnique(&scene.rendering.technique, test_support::kMetaball);
    test_support::MetaballsOf(scene.rendering.technique).count = count;
    return scene;
  }

  static std::uint64_t Show(session::Session& session, const scene::Scene& scene) {
    const std::uint64_t revision = session.TakeRevision();
    session.Show(revision, scene);
    return revision;
  }

  // Waits for the frame at rest (at full quality) of this revision, after an earlier frame of it
  // was shown.
  bool AwaitAtRest(EagerViewer& viewer, std::uint64_t revision) {
    if (!viewer.Await(revision, false)) return false;
    time_.Advance(seconds(1));
    return viewer.Await(revision, true);
  }

  // Makes the render loop draw two pictures, so that it has checked all of its work twice when this
  // returns.
  void GoAround() {
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(Picture(0.0).get().ok());
  }

  // Returns the number of pictures that were drawn with the sun at this azimuth.
  std::ptrdiff_t DrawnFrom(double sun_azimuth_deg) const {
    return std::ranges::count_if(machine_->Log(), [&](const FakeMachine::Drawn& drawn) {
      return drawn.scene.sun.azimuth_deg == sun_azimuth_deg;
    });
  }

  // Draws the first frame of a setting, whose time does not count, and a few more frames, so that
  // the frames' cost is known.
  void LearnCosts(session::Session& session, EagerViewer& viewer) const {
    const double ms_per_mega_sample = machine_->ms_per_mega_sample;
    machine_->ms_per_mega_sample = 0.0;
    ASSERT_TRUE(viewer.Await(Show(session, Small(300.0)), false));
    machine_->ms_per_mega_sample = ms_per_mega_sample;
    for (int i = 1; i < 5; ++i) ASSERT_TRUE(viewer.Await(Show(session, Small(300.0 + i)), false));
  }

  std::future<absl::StatusOr<DisplayFrame>> Picture(
      double exposure_ev,
      std::shared_ptr<std::atomic<bool>> cancelled = std::make_shared<std::atomic<bool>>(false)) {
    scene::Scene scene = Small(0.0);
    scene.display.exposure_ev = exposure_ev;
    return Picture(scene, std::move(cancelled));
  }

  std::future<absl::StatusOr<DisplayFrame>> Picture(
      const scene::Scene& scene,
      std::shared_ptr<std::atomic<bool>> cancelled = std::make_shared<std::atomic<bool>>(false),
      const std::string& owner = "", const std::function<void()>& before_reading = [] {}) {
    auto promise = std::make_shared<std::promise<absl::StatusOr<DisplayFrame>>>();
    auto future = promise->get_future();
    loop_->RenderImage({.scene = scene,
                        .read = [this, scene, before_reading]() -> absl::StatusOr<ImageInput> {
                          before_reading();
                          return ImageInput{*store_.Get("anvil", 0, {}), scene.camera};
                        },
                        .encode = [](DisplayFrame&) { return absl::OkStatus(); },
                        .cancelled = std::move(cancelled),
                        .done =
                            [promise](absl::StatusOr<DisplayFrame> picture) {
                              promise->set_value(std::move(picture));
                            },
                        .owner = owner});
    return future;
  }

  testing::ManualTime time_;
  base::WakeSignal wake_;
  FakeStormStore store_;
  const std::shared_ptr<FakeMachine> machine_ = std::make_shared<FakeMachine>();
  session::Sessions sessions_{session::SessionsOptions{.time = &time_},
                              {[this] { wake_.Notify(); }, [] {}}};
  std::mutex viewers_mutex_;  // tests with several threads add viewers
  std::vector<std::shared_ptr<EagerViewer>> viewers_;
  std::unique_ptr<RenderLoop> loop_;
};

TEST_F(RenderLoopTest, NewestSceneIsTheLastShown) {
  machine_->ms_per_mega_sample = 500.0;
  Start();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  machine_->drawing.Close();
  Show(*session, Small(0.0));
  ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
  std::uint64_t revision = 0;
  for (int i = 1; i < 1000; ++i) revision = Show(*session, Small(0.1 * i));
  machine_->drawing.Open();
  ASSERT_TRUE(AwaitAtRest(*viewer, revision));
  for (const FakeMachine::Drawn& drawn : machine_->Log()) {
    const double azimuth_deg = drawn.scene.sun.azimuth_deg;
    EXPECT_TRUE(azimuth_deg == 0.0 || azimuth_deg == 0.1 * 999) << azimuth_deg;
  }
}

TEST_F(RenderLoopTest, PicturesAndSessionsDoNotStarveOneAnother) {
  machine_->ms_per_mega_sample = 1000.0;  // 37 ms for each picture
  Start();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  std::uint64_t shown = Show(*session, Small(0.0));
  ASSERT_TRUE(AwaitAtRest(*viewer, shown));
  machine_->drawing.Close();
  std::vector<std::future<absl::StatusOr<DisplayFrame>>> pictures;
  for (int i = 0; i < 10; ++i) pictures.push_back(Picture(1.0));
  int drawn = 0;
  int in_a_row = 0;
  while (drawn < 10) {
    ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
    const bool is_picture = machine_->Log().back().scene.display.exposure_ev == 1.0;
    // The scene is updated so often that the session always has a newer scene than the one being
    // drawn.
    const std::uint64_t before =
        std::exchange(shown, Show(*session, Small(static_cast<double>(shown % 300))));
    machine_->drawing.LetOnePass();
    if (is_picture) {
      ++drawn;
      // One picture is drawn between two frames, unless the session's last frame is still being
      // encoded.
      EXPECT_LE(++in_a_row, 3);
    } else {
      in_a_row = 0;
      ASSERT_TRUE(viewer->Await(before, false));
    }
  }
  machine_->drawing.Open();
  for (auto& picture : pictures) EXPECT_TRUE(picture.get().ok());
}

// The full frame of one session takes a second, while the camera of another session moves.
TEST_F(RenderLoopTest, AFrameAtRestHoldsUpNoMovingOne) {
  machine_->ms_per_mega_sample = 27000.0;  // a second for each full frame, 16 ms for a coarse one
  Start();
  const auto resting = *sessions_.Create();
  const auto moving = *sessions_.Create();
  const auto resting_viewer = Watch(resting);
  const auto moving_viewer = Watch(moving);
  LearnCosts(*moving, *moving_viewer);
  Show(*resting, Small(5.0));
  const auto is_shown = [&] {
    return resting_viewer->Has(1, [](const delivery::EncodedFrame& frame) {
      return frame.refined && frame.modelled.slices == 16;
    });
  };
  machine_->next_piece.Close();
  for (int i = 0; !is_shown(); ++i) {
    ASSERT_LT(i, 10'000) << "the frame at rest ends, too";
    const double azimuth_deg = 100.0 + 0.01 * i;
    const std::uint64_t shown = Show(*moving, Small(azimuth_deg));
    // Drawn whole, the frame at rest would delay one of the moving frames by a second.
    const int pieces = machine_->PiecesUntil([&](const FakeMachine::Drawn& drawn) {
      return drawn.scene.sun.azimuth_deg == azimuth_deg;
    });
    ASSERT_GE(pieces, 0);
    EXPECT_LE(pieces, 2) << "of 10 ms, before a moving frame";
    ASSERT_TRUE(moving_viewer->Await(shown, false));
  }
  EXPECT_GT(machine_->pieces, 50);
}

TEST_F(RenderLoopTest, AFrameAtRestEndsWhenItsSceneChanges) {
  machine_->ms_per_mega_sample = 27000.0 * 4;  // four seconds for each full frame
  Start();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  LearnCosts(*session, *viewer);
  machine_->next_piece.Close();
  machine_->next_piece.LetPass(10);
  ASSERT_TRUE(viewer->Await(Show(*session, Small(5.0)), false));
  time_.Advance(seconds(1));
  ASSERT_TRUE(WaitFor([&] { return machine_->pieces == 10; }));
  ASSERT_TRUE(machine_->next_piece.AwaitWaiting(1));
  const std::uint64_t revision = Show(*session, Small(6.0));
  machine_->next_piece.Open();
  ASSERT_TRUE(viewer->Await(revision, false));
  EXPECT_EQ(machine_->pieces, 11) << "of 400";
}

TEST_F(RenderLoopTest, WhatAScenePreparesHoldsUpNobodyElse) {
  Start();
  const auto fitting = *sessions_.Create();
  const auto other = *sessions_.Create();
  const auto fitting_viewer = Watch(fitting);
  const auto other_viewer = Watch(other);
  // The scene's fields are available; only the fit is missing.
  Show(*fitting, Small(0.0));
  ASSERT_TRUE(fitting_viewer->Await(1, true));
  machine_->preparing.Close();
  Show(*fitting, OfMetaballs(100));
  ASSERT_TRUE(machine_->preparing.AwaitWaiting(1));
  Show(*other, Small(5.0));
  ASSERT_TRUE(other_viewer->Await(1, true));
  // The scene changes to another number of metaballs during the first fit. The picture with the
  // first number may be shown, and the picture with the last number must be shown.
  const std::uint64_t last = Show(*fitting, OfMetaballs(200));
  machine_->preparing.Open();
  ASSERT_TRUE(fitting_viewer->Await(last, true));
  EXPECT_EQ(std::get<scene::Metaballs>(machine_->Log().back().scene.rendering.technique).count,
            200);
}

TEST_F(RenderLoopTest, ASeriesThatGoesOnIsPreparedAheadOfItsPictures) {
  Start();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(Show(*session, OfMetaballs(100)), true));
  EXPECT_FALSE(machine_->IsPrepared(OfMetaballs(100, 1))) << "nothing plays yet";
  ASSERT_TRUE(viewer->Await(Show(*session, OfMetaballs(100, 1)), true));
  ASSERT_TRUE(machine_->AwaitPrepared(OfMetaballs(100, 2)));
  // The next picture is drawn without waiting, although the picture after it is not ready.
  machine_->preparing.Close();
  ASSERT_TRUE(viewer->Await(Show(*session, OfMetaballs(100, 2)), true));
  ASSERT_TRUE(machine_->preparing.AwaitWaiting(1));
  EXPECT_FALSE(machine_->IsPrepared(OfMetaballs(100, 3)));
  machine_->preparing.Open();
  ASSERT_TRUE(machine_->AwaitPrepared(OfMetaballs(100, 3)));
  ASSERT_TRUE(viewer->Await(Show(*session, OfMetaballs(100, 3)), true)) << "the last";
}

TEST_F(RenderLoopTest, APreparationThatFailsIsAProblemOfItsScene) {
  Start();
  machine_->cannot_prepare = 100;
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  Show(*session, OfMetaballs(100));
  ASSERT_TRUE(viewer->AwaitProblem("it cannot be fitted"));
  const std::uint64_t revision = Show(*session, OfMetaballs(200));
  EXPECT_TRUE(viewer->Await(revision, true));
}

TEST_F(RenderLoopTest, LightThatCannotBeTracedIsSaidByThePictureItself) {
  Start();
  machine_->cannot_trace_azimuth_deg = 123.0;
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  scene::Scene scene = Small(123.0);
  scene.rendering.technique = scene::LightVolume{};
  const std::uint64_t revision = Show(*session, scene);
  ASSERT_TRUE(viewer->Await(revision, true));
  time_.Advance(seconds(1));
  const auto frame = viewer->AwaitUntraced();
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->scene_revision, revision);
  EXPECT_TRUE(frame->refined);
  const scene::NotShown& entry = frame->modelled.content.not_shown.front();
  EXPECT_EQ(entry.code, scene::NotShown::Code::kTracedLight);
  EXPECT_THAT(entry.message, HasSubstr("cannot trace that"));
  const std::size_t events = viewer->EventCount();
  time_.Advance(seconds(60));
  GoAround();
  EXPECT_EQ(machine_->trace_failures, 1) << "it is not tried again";
  EXPECT_EQ(viewer->EventCount(), events);
  EXPECT_EQ(viewer->ProblemCount(), 0U);
}

// The table has only settings of the metaball technique, so this technique is used whatever the
// scene requests.
TEST_F(RenderLoopTest, APictureIsPreparedForTheSettingDecidedAndHoldsUpNobody) {
  RenderLoopOptions options;
  options.offer_tables = [] {
    accuracy::PricedSettings table;
    table.size_px = {64, 36};
    table.rows.push_back({{OfMetaballs(300).rendering.technique}, 10.0, 0.3});
    accuracy::OfferTables tables;
    tables.fill(table);
    return tables;
  };
  Start(options);
  machine_->preparing.Close();
  scene::Scene scene = Small(0.0);
  scene.accuracy = scene::MaxError{0.4};
  auto fitted = Picture(scene);
  ASSERT_TRUE(machine_->preparing.AwaitWaiting(1));
  EXPECT_TRUE(Picture(1.0).get().ok());
  machine_->preparing.Open();
  const auto picture = fitted.get();
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->modelled.technique, "metaball");
  EXPECT_EQ(picture->stages[0].stage, scene::FrameStage::kRead);
  EXPECT_EQ(picture->stages[1].stage, scene::FrameStage::kFit);
  machine_->cannot_prepare = 200;
  EXPECT_EQ(Picture(OfMetaballs(200)).get().status().message(), "it cannot be fitted");
}

TEST_F(RenderLoopTest, PicturesYieldToSessionsButNotToOtherProgramsWhereThereAreNone) {
  for (const bool yield : {true, false}) {
    Start({.workers_yield = yield});
    ASSERT_TRUE(Picture(1.0).get().ok());
    const auto log = machine_->Log();
    ASSERT_FALSE(log.empty());
    EXPECT_EQ(log.back().niceness > 0, yield);
    loop_.reset();
  }
}

// A picture that must wait before it may trace light lets the next picture proceed.
TEST_F(RenderLoopTest, PicturesClaimTheLightThatTheyAwait) {
  Start();
  const auto lit_from = [&](double azimuth_deg) {
    scene::Scene scene = Small(azimuth_deg);
    scene.rendering.technique = scene::LightVolume{.traced_light = scene::TracedLight::kAwaited};
    return Picture(scene);
  };
  machine_->waits_to_trace_azimuth_deg = 200.0;
  machine_->tracing.Close();
  auto waits = lit_from(200.0);
  auto traced = lit_from(100.0);
  ASSERT_TRUE(machine_->tracing.AwaitWaiting(1));
  machine_->tracing.LetOnePass();
  ASSERT_TRUE(WaitFor([&] { return machine_->traced_steps == 1; }));
  ASSERT_TRUE(machine_->tracing.AwaitWaiting(1)) << "the second step";
  EXPECT_EQ(machine_->light.use_count(), 3) << "the picture's claim, and that of the step";
  machine_->tracing.Open();
  EXPECT_TRUE(traced.get().ok());
  EXPECT_EQ(machine_->traced_steps, 10);
  EXPECT_EQ(machine_->light.use_count(), 1) << "it is done";
  const int refusals = machine_->trace_refusals;
  time_.Advance(seconds(1));
  wake_.Notify();
  ASSERT_TRUE(WaitFor([&] { return machine_->trace_refusals > refusals; }));
  GoAround();
  EXPECT_EQ(waits.wait_for(seconds(0)), std::future_status::timeout);
  machine_->waits_to_trace_azimuth_deg = -1.0;
  time_.Advance(seconds(1));
  EXPECT_TRUE(waits.get().ok());
}

TEST_F(RenderLoopTest, APictureDoesNotAwaitItsLightForEver) {
  Start();
  machine_->tracing.Close();
  scene::Scene scene = Small(0.0);
  scene.rendering.technique = scene::LightVolume{.traced_light = scene::TracedLight::kAwaited};
  std::promise<absl::Status> ended;
  loop_->RenderImage({.scene = scene,
                      .read = [&]() -> absl::StatusOr<ImageInput> {
                        return ImageInput{*store_.Get("anvil", 0, {}), scene.camera};
                      },
                      .encode = [](DisplayFrame&) { return absl::OkStatus(); },
                      .cancelled = std::make_shared<std::atomic<bool>>(false),
                      .done = [&](const auto& picture) { ended.set_value(picture.status()); },
                      .max_work_ms = 300.0,
                      .too_long = absl::ResourceExhaustedError("too long")});
  auto future = ended.get_future();
  ASSERT_TRUE(machine_->tracing.AwaitWaiting(1));
  GoAround();
  EXPECT_EQ(future.wait_for(seconds(0)), std::future_status::timeout);
  time_.Advance(milliseconds(301));
  wake_.Notify();
  ASSERT_EQ(future.wait_for(testing::kPatience), std::future_status::ready);
  EXPECT_EQ(future.get().message(), "too long");
}

// There are forty pictures of one caller, then two of another. These two are drawn first although
// all but the first ten of the forty cannot be read until then.
TEST_F(RenderLoopTest, PicturesTakeTurnsByWhoAskedForThem) {
  machine_->ms_per_mega_sample = 1000.0;  // 37 ms for each picture
  testing::Gate later_pictures;
  later_pictures.Close();
  Start();
  machine_->drawing.Close();
  const auto not_cancelled = std::make_shared<std::atomic<bool>>(false);
  std::vector<std::future<absl::StatusOr<DisplayFrame>>> many;
  for (int i = 0; i < 40; ++i) {
    many.push_back(Picture(Small(0.0), not_cancelled, "pipeline", [&later_pictures, i] {
      if (i >= 10) later_pictures.Pass();
    }));
  }
  auto first = Picture(Small(0.0), not_cancelled, "ben");
  auto second = Picture(Small(0.0), not_cancelled, "ben");
  ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
  machine_->drawing.Open();
  const bool were_drawn = first.wait_for(testing::kPatience) == std::future_status::ready &&
                          second.wait_for(testing::kPatience) == std::future_status::ready;
  later_pictures.Open();
  ASSERT_TRUE(were_drawn) << "they waited for all pictures that were requested earlier";
  EXPECT_TRUE(first.get().ok());
  EXPECT_TRUE(second.get().ok());
  for (auto& picture : many) EXPECT_TRUE(picture.get().ok());
}

TEST_F(RenderLoopTest, OneIdentityDoesNotFillTheQueue) {
  RenderLoopOptions options;
  options.max_waiting_images = 100;
  options.max_waiting_images_each = 10;
  Start(options);
  machine_->drawing.Close();
  std::vector<std::future<absl::StatusOr<DisplayFrame>>> many;
  const auto ask = [&](const std::string& owner) {
    return Picture(Small(0.0), std::make_shared<std::atomic<bool>>(false), owner);
  };
  many.push_back(ask("pipeline"));
  ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
  for (int i = 0; i < 20; ++i) many.push_back(ask("pipeline"));
  auto other = ask("ben");
  machine_->drawing.Open();
  int refused = 0;
  for (auto& picture : many) {
    const absl::Status status = picture.get().status();
    if (status.ok()) continue;
    ++refused;
    EXPECT_EQ(base::DetailsOf(status).reason, "RENDER_QUEUE_FULL");
    EXPECT_THAT(std::string(status.message()), HasSubstr("of your pictures"));
  }
  EXPECT_GE(refused, 8);
  EXPECT_TRUE(other.get().ok());
}

TEST_F(RenderLoopTest, CancelledPicturesAreDroppedAndSayso) {
  Start();
  machine_->drawing.Close();
  auto first = Picture(1.0);
  ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
  const auto cancelled = std::make_shared<std::atomic<bool>>(false);
  auto second = Picture(2.0, cancelled);
  auto third = Picture(3.0);
  *cancelled = true;
  machine_->drawing.Open();
  EXPECT_TRUE(first.get().ok());
  EXPECT_EQ(second.get().status().code(), absl::StatusCode::kCancelled);
  EXPECT_TRUE(third.get().ok());
  for (const auto& drawn : machine_->Log()) EXPECT_NE(drawn.scene.display.exposure_ev, 2.0);
}

TEST_F(RenderLoopTest, StopRefusesPicturesThatWait) {
  RenderLoopOptions options;
  options.max_waiting_images = 1;
  Start(options);
  machine_->drawing.Close();
  auto drawn = Picture(1.0);
  ASSERT_TRUE(machine_->drawing.AwaitWaiting(1));
  auto waiting = Picture(2.0);
  auto refused = Picture(3.0);
  EXPECT_THAT(std::string(refused.get().status().message()),
              HasSubstr("1 pictures wait to be drawn"));
  loop_->RequestStop();
  machine_->drawing.Open();
  loop_->Stop();
  EXPECT_TRUE(drawn.get().ok());
  EXPECT_EQ(waiting.get().status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(Picture(4.0).get().status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(RenderLoopTest, ASessionThatNobodyWatchesLetsGoOfItsFields) {
  Start();
  const auto session = *sessions_.Create();
  Show(*session, Small(0.0));
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(1, true));
  viewer->Leave();
  wake_.Notify();
  const std::uint64_t revision = Show(*session, Small(10.0));
  GoAround();
  EXPECT_EQ(DrawnFrom(10.0), 0);
  const auto again = Watch(session);
  EXPECT_TRUE(again->Await(revision, true));
}

TEST_F(RenderLoopTest, TheFrameOfASessionThatNobodyWatchesMakesRoomForAPicture) {
  RenderLoopOptions options;
  options.memory = base::MemoryBudget::Make({.bytes = std::size_t{1} << 20});
  options.device_memory = {options.memory};
  Start(options);
  scene::Scene large = Small(0.0);
  large.output = {400, 300, 88};  // its pixels need 720 kB
  const auto session = *sessions_.Create();
  const std::uint64_t revision = Show(*session, large);
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(revision, true));
  viewer->Leave();
  viewer->Forget();
  // The encoder of resting frames keeps the picture a moment longer.
  absl::Status drawn = absl::UnknownError("not asked for");
  EXPECT_TRUE(WaitFor([&] {
    time_.Advance(milliseconds(100));
    drawn = Picture(large).get().status();
    return drawn.ok();
  })) << drawn;
  const auto again = Watch(session);
  EXPECT_TRUE(again->Await(revision, true)) << "it is drawn once more";
}

TEST_F(RenderLoopTest, PicturesOfOneIdentityTakeNoMoreThanHalfOfTheBudget) {
  RenderLoopOptions options;
  options.memory = base::MemoryBudget::Make({.bytes = std::size_t{4} << 20});
  options.device_memory = {options.memory};
  Start(options);
  scene::Scene large = Small(0.0);
  large.output = {400, 300, 88};  // 720 kB, so that two are below 2 MiB
  const auto open = [&](const std::string& owner) { return *sessions_.Create({}, owner); };
  const auto shows = [&](const std::shared_ptr<session::Session>& session) {
    const std::uint64_t revision = Show(*session, large);
    return Watch(session)->Await(revision, true);
  };
  const auto first = open("anna");
  ASSERT_TRUE(shows(first));
  ASSERT_TRUE(shows(open("anna")));
  const auto third = open("anna");
  const std::uint64_t revision = Show(*third, large);
  const auto viewer = Watch(third);
  EXPECT_TRUE(WaitFor([&] { return viewer->ProblemCount() >= 1; }));
  EXPECT_FALSE(
      viewer->Has(revision, [](const delivery::EncodedFrame& frame) { return frame.refined; }));
  EXPECT_TRUE(shows(open("ben"))) << "others have theirs";
  ASSERT_TRUE(sessions_.Close(first->keys().presenter).ok());
  time_.Advance(seconds(11));
  EXPECT_TRUE(viewer->Await(revision, true)) << "it is tried again by itself";
}

TEST_F(RenderLoopTest, ManyHandsManyViewersComingAndGoing) {
  machine_->ms_per_mega_sample = 20.0;
  store_.FailAt(3, absl::DataLossError("broken"));
  RenderLoopOptions options;
  options.encoder_threads = 2;
  Start(options);
  std::vector<std::thread> hands;
  for (int hand = 0; hand < 4; ++hand) {
    hands.emplace_back([this, hand] {
      const auto session = *sessions_.Create();
      for (int round = 0; round < 15; ++round) {
        const auto viewer = Watch(session);
        scene::Scene scene = Small(10.0 * round);
        scene.time_index = (hand + round) % 4;
        const std::uint64_t revision = Show(*session, scene);
        if (scene.time_index != 3) {
          EXPECT_TRUE(viewer->Await(revision, false));
        }
        viewer->Leave();
      }
      EXPECT_TRUE(Picture(1.0).get().ok());
      EXPECT_TRUE(sessions_.Close(session->keys().presenter).ok());
    });
  }
  for (std::thread& hand : hands) hand.join();
}

TEST_F(RenderLoopTest, StopsAmidWork) {
  machine_->ms_per_mega_sample = 20.0;
  Start();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  std::atomic<bool> stop{false};
  std::thread hand([&] {
    for (int i = 0; !stop; ++i) {
      scene::Scene scene = Small(i % 300);
      scene.time_index = i / 10 % 4;
      Show(*session, scene);
    }
  });
  ASSERT_TRUE(viewer->Await(1, false));
  loop_->Stop();
  stop = true;
  hand.join();
}

TEST(SessionTest, OlderRevisionNeverReplacesANewer) {
  session::Session session("id", {"p", "v"}, {}, {}, {}, {[] {}, [] {}});
  const std::uint64_t early = session.TakeRevision();
  const std::uint64_t late = session.TakeRevision();
  scene::Scene scene = test_support::PlainScene();
  scene.time_index = 2;
  session.Show(late, scene);
  scene.time_index = 1;
  session.Show(early, scene);
  ASSERT_TRUE(session.Newest().has_value());
  EXPECT_EQ(session.Newest()->revision, late);
  EXPECT_EQ(session.Newest()->scene->time_index, 2);
}

// A fixture for tests of a lost graphics device. After the loss, everything that was made with the
// device must be made again.
class DeviceLossTest : public RenderLoopTest {
 protected:
  static RenderLoopOptions WithLosses(int max_losses) {
    RenderLoopOptions options;
    options.losses = {.first_pause = milliseconds(0), .max_losses = max_losses};
    return options;
  }

  static scene::Scene Exposed(double exposure_ev) {
    scene::Scene scene = Small(0.0);
    scene.display.exposure_ev = exposure_ev;
    return scene;
  }
};

TEST_F(DeviceLossTest, SessionsGoOnAtTheSameRevision) {
  Start(WithLosses(6));
  const auto before = telemetry::Counted().device_losses.Value();
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(Show(*session, Small(0.0)), true));
  machine_->losses = 1;
  const std::uint64_t revision = Show(*session, Small(10.0));
  EXPECT_TRUE(viewer->Await(revision, true));
  EXPECT_EQ(viewer->ProblemCount(), 0U);
  EXPECT_EQ(machine_->losses, 0);
  EXPECT_GE(machine_->opened, 2) << "another source";
  EXPECT_EQ(telemetry::Counted().device_losses.Value(), before + 1);
  EXPECT_FALSE(loop_->IsRecovering());
}

TEST_F(DeviceLossTest, SoDoPicturesOutsideSessions) {
  Start(WithLosses(6));
  machine_->losses = 1;
  auto picture = Picture(1.0);
  EXPECT_TRUE(picture.get().ok());
  EXPECT_EQ(machine_->losses, 0);
}

TEST_F(DeviceLossTest, ADeviceThatCannotBeOpenedIsTriedAgain) {
  Start(WithLosses(6));
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(Show(*session, Small(0.0)), true));
  machine_->cannot_open = 3;
  machine_->losses = 1;
  EXPECT_TRUE(viewer->Await(Show(*session, Small(10.0)), true));
  EXPECT_EQ(machine_->cannot_open, 0);
}

// The server requests a restart when a turn takes too long, so a driver that hangs while opening
// must count as a turn.
TEST_F(DeviceLossTest, OpeningTheDeviceAgainCountsAsATurn) {
  Start(WithLosses(6));
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(Show(*session, Small(0.0)), true));
  machine_->opening.Close();
  machine_->losses = 1;
  const std::uint64_t revision = Show(*session, Small(10.0));
  ASSERT_TRUE(machine_->opening.AwaitWaiting(1));
  time_.Advance(milliseconds(1500));
  EXPECT_DOUBLE_EQ(loop_->TurnSeconds(), 1.5);
  machine_->opening.Open();
  EXPECT_TRUE(viewer->Await(revision, true));
}

TEST_F(DeviceLossTest, ASceneThatTheDeviceDoesNotBearFailsAlone) {
  Start(WithLosses(6));
  machine_->loses_above_exposure_ev = 2.0;
  const auto killer = *sessions_.Create();
  const auto other = *sessions_.Create();
  const auto killers_viewer = Watch(killer);
  const auto others_viewer = Watch(other);
  Show(*killer, Exposed(3.0));
  EXPECT_TRUE(killers_viewer->AwaitProblem(std::string(gl::DeviceLost().message())));
  EXPECT_TRUE(others_viewer->Await(Show(*other, Small(10.0)), true));
  auto picture = Picture(3.0);
  EXPECT_TRUE(gl::IsDeviceLost(picture.get().status()));
  EXPECT_TRUE(others_viewer->Await(Show(*other, Small(20.0)), true));
}

TEST_F(DeviceLossTest, IsGivenUpWhenItComesTooOften) {
  RenderLoopOptions options = WithLosses(3);
  std::promise<absl::Status> given_up;
  options.on_device_given_up = [&](const absl::Status& why) { given_up.set_value(why); };
  Start(options);
  const auto session = *sessions_.Create();
  const auto viewer = Watch(session);
  ASSERT_TRUE(viewer->Await(Show(*session, Small(0.0)), true));
  machine_->cannot_open = 1000;
  machine_->losses = 1;
  Show(*session, Small(10.0));
  auto future = given_up.get_future();
  ASSERT_EQ(future.wait_for(testing::kPatience), std::future_status::ready);
  const absl::Status why = future.get();
  EXPECT_TRUE(absl::IsUnavailable(why));
  EXPECT_THAT(std::string(why.message()), HasSubstr("there is no device"));
  EXPECT_EQ(machine_->cannot_open, 997);
  EXPECT_FALSE(Picture(1.0).get().ok()) << "refused, not left waiting";
}

TEST_F(DeviceLossTest, WhatHasNoRoomInMemoryIsRefusedByNameAndComesWhenThereIs) {
  RenderLoopOptions options;
  options.memory = base::MemoryBudget::Make({.bytes = 1 << 20});
  Start(options);
  auto taken = options.memory->Reserve(base::MemoryUse::kFields, 1 << 20, "all").value();
  const absl::Status refused = Picture(1.0).get().status();
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("a picture needs"));
  taken = {};
  EXPECT_TRUE(Picture(1.0).get().ok());
}

TEST(DeviceLossesTest, PausesGrowUntilItIsGivenUpAndAreForgotten) {
  const LossLimits limits{milliseconds(100), 4, milliseconds(10'000)};
  DeviceLosses losses(limits);
  const session::Clock::time_point start{};
  EXPECT_EQ(losses.Lost(start), start);
  EXPECT_EQ(losses.Lost(start), start + milliseconds(100));
  EXPECT_EQ(losses.Lost(start), start + milliseconds(200));
  EXPECT_EQ(losses.Lost(start), start + milliseconds(400));
  EXPECT_EQ(losses.Lost(start), std::nullopt);
  const auto later = start + limits.window;
  EXPECT_EQ(losses.Lost(later), later);
}

}  // namespace
}  // namespace thunderhead::drawing
