// Tests of a worker, a thread that draws single pictures by OpenGL in the turns that it is given.
// The worker must draw in pieces, and must end when its picture is no longer wanted.
#include "drawing/worker.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "base/error_details.h"
#include "base/stopwatch.h"
#include "drawing/gl_frame_source.h"
#include "gtest/gtest.h"
#include "storm_store/storm_store.h"
#include "tests/support/figure.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead::drawing {
namespace {

class WorkerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    worker_ = std::make_unique<Worker>(GlFrameSources(test_support::Device()), 0, [] {});
    auto store = storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"},
                                               {.read_ahead = 0});
    ASSERT_TRUE(store.ok()) << store.status();
    auto fields = (*store)->Get("supercell", 1, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    fields_ = *fields;
  }

  scene::Scene SceneOf(int width_px, int height_px, int slices) const {
    scene::Scene scene;
    scene.output = {width_px, height_px, 90};
    scene::SetSlices(&scene.rendering.technique, slices);
    std::get<scene::OrbitCamera>(scene.camera).distance_m = 40e3;
    return scene;
  }

  void Begin(const scene::Scene& scene, const FrameQuality& quality = {}) {
    worker_->Begin(
        [this, scene, quality](const absl::StatusOr<FrameSource*>& source) {
          auto picture = source.ok() ? (*source)->Draw(scene, fields_, quality) : source.status();
          drawn_ = picture.status();
          if (picture.ok()) rgb_ = std::move(picture->rgb);
        },
        {cancelled_});
  }

  absl::StatusOr<DisplayFrame> DrawWhole(const scene::Scene& scene, const FrameQuality& quality) {
    const auto source = GlFrameSources(test_support::Device())(nullptr);
    return source.ok() ? (*source)->Draw(scene, fields_, quality) : source.status();
  }

  // Gives turns until the work has ended; returns the duration of each piece in milliseconds.
  std::vector<double> Finish() {
    std::vector<double> pieces_ms;
    while (!worker_->IsIdle()) {
      if (worker_->WantsTurn()) {
        pieces_ms.push_back(worker_->GiveTurn());
      } else {
        std::this_thread::yield();
      }
    }
    return pieces_ms;
  }

  const std::shared_ptr<std::atomic<bool>> cancelled_ = std::make_shared<std::atomic<bool>>(false);
  absl::Status drawn_ = absl::UnknownError("not drawn");
  std::vector<std::uint8_t> rgb_;
  std::unique_ptr<Worker> worker_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
};

TEST_F(WorkerTest, AFrameOfASmallerOutputIsTheSmallerPicture) {
  for (const bool sparse : {false, true}) {
    const auto half = DrawWhole(SceneOf(320, 180, 64), {.sparse = sparse, .output_scale = 0.5});
    const auto small = DrawWhole(SceneOf(160, 90, 64), {.sparse = sparse});
    ASSERT_TRUE(half.ok()) << half.status();
    ASSERT_TRUE(small.ok()) << small.status();
    EXPECT_EQ(half->width_px, 160);
    EXPECT_EQ(half->height_px, 90);
    EXPECT_TRUE(half->rgb == small->rgb);
  }
}

class WorkerBenchmark : public WorkerTest {
 protected:
  void TellPieces(const scene::Scene& scene, const FrameQuality& quality) {
    Begin(SceneOf(320, 180, 128), quality);
    Finish();
    ASSERT_TRUE(drawn_.ok()) << drawn_;
    // The first picture has compiled the programs and prepared the storm, so the next one is timed
    // without that work.
    Begin(scene, quality);
    std::vector<double> pieces_ms = Finish();
    ASSERT_TRUE(drawn_.ok()) << drawn_;
    ASSERT_FALSE(pieces_ms.empty());
    std::ranges::sort(pieces_ms);
    const std::string name = quality.sparse ? "piece of a sparse picture" : "piece of a picture";
    testing::Figure((name + ", 95th percentile").c_str(), pieces_ms[pieces_ms.size() * 95 / 100],
                    "ms");
    testing::Figure((name + ", longest").c_str(), pieces_ms.back(), "ms");
  }
};

TEST_F(WorkerBenchmark, PiecesOfALargePicture) { TellPieces(SceneOf(1920, 1080, 512), {}); }

// Most of the drawing time is spent on the CPU, which completes the picture. The graphics device is
// free for other work meanwhile.
TEST_F(WorkerBenchmark, PiecesOfALargePictureWithFewerRays) {
  TellPieces(SceneOf(1920, 1080, 256), {.sparse = true});
}

TEST_F(WorkerTest, LargePicturesAreDrawnInPieces) {
  Begin(SceneOf(1280, 720, 512));
  EXPECT_GT(Finish().size(), 20U);
  EXPECT_TRUE(drawn_.ok()) << drawn_;
}

TEST_F(WorkerTest, APictureWithFewerRaysIsTheSameInPieces) {
  const FrameQuality sparse{.sparse = true};
  const scene::Scene large = SceneOf(1280, 720, 256);
  Begin(large, sparse);
  EXPECT_GT(Finish().size(), 10U);
  ASSERT_TRUE(drawn_.ok()) << drawn_;
  const auto whole = DrawWhole(large, sparse);
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_TRUE(whole->rgb == rgb_);
}

// The version of the picture with more bits a channel is kept for the high-quality encoding at
// rest, until another picture is drawn. It can be taken once.
TEST_F(WorkerTest, APictureWithFewerRaysIsThereWithMoreBitsOnce) {
  const auto source = GlFrameSources(test_support::Device())(nullptr);
  ASSERT_TRUE(source.ok()) << source.status();
  const auto picture = (*source)->Draw(SceneOf(320, 180, 64), fields_, {.sparse = true});
  ASSERT_TRUE(picture.ok()) << picture.status();
  const auto fine = (*source)->Fine();
  ASSERT_TRUE(fine.ok()) << fine.status();
  EXPECT_EQ(fine->rgb.size(), picture->rgb.size());
  EXPECT_FALSE((*source)->Fine().ok());
}

TEST_F(WorkerTest, WhatNobodyWantsFreesTheDeviceAtOnce) {
  for (const int after_pieces : {1, 10, 40}) {
    *cancelled_ = false;
    Begin(SceneOf(3840, 2160, 512));
    for (int pieces = 0; pieces < after_pieces && !worker_->IsIdle();) {
      if (worker_->WantsTurn()) {
        worker_->GiveTurn();
        ++pieces;
      } else {
        std::this_thread::yield();
      }
    }
    ASSERT_FALSE(worker_->IsIdle()) << "it has few pieces";
    *cancelled_ = true;
    const base::Stopwatch since_cancelled;
    EXPECT_TRUE(Finish().empty()) << "it drew on";
    testing::Figure("work without the device after a picture was cancelled",
                    since_cancelled.ElapsedMs(), "ms");
    EXPECT_TRUE(absl::IsCancelled(drawn_)) << drawn_;
  }
}

// Paths are traced without the device. Tracing cannot end at the next drawn piece, so it must check
// on its own.
TEST_F(WorkerTest, TracingEndsWhenNobodyWantsItAnyMore) {
  absl::StatusOr<accuracy::LightProgress> light = absl::UnknownError("not traced");
  absl::StatusOr<accuracy::ErrorProgress> error = absl::UnknownError("not measured");
  worker_->Begin(
      [&](const absl::StatusOr<FrameSource*>& source) {
        const scene::Scene scene = SceneOf(160, 90, 64);
        drawn_ = (*source)->MeasureError(scene, fields_).status();
        *cancelled_ = true;
        error = (*source)->MeasureError(scene, fields_);
        light = (*source)->TraceLight(scene, fields_, 1'000'000, nullptr);
      },
      {cancelled_});
  Finish();
  EXPECT_TRUE(drawn_.ok()) << drawn_ << ", before it was cancelled";
  EXPECT_TRUE(absl::IsCancelled(error.status())) << error.status();
  EXPECT_TRUE(absl::IsCancelled(light.status())) << light.status();
}

TEST_F(WorkerTest, MoreTimeThanItsLimitEndsTheWork) {
  worker_->Begin(
      [this](const absl::StatusOr<FrameSource*>& source) {
        drawn_ = (*source)->Draw(SceneOf(1280, 720, 512), fields_, {}).status();
      },
      {nullptr, 0.01});
  EXPECT_EQ(Finish().size(), 1U);
  EXPECT_TRUE(absl::IsResourceExhausted(drawn_)) << drawn_;
  const base::ErrorDetails details = base::DetailsOf(drawn_);
  EXPECT_EQ(details.reason, "PICTURE_TOO_COSTLY");
  EXPECT_TRUE(details.permanent) << "the same picture would take as long again";
}

}  // namespace
}  // namespace thunderhead::drawing
