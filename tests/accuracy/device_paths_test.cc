// Tests of paths that are traced on the graphics device. They are compared with the CPU's paths in
// the same scene, because both estimate the same radiance.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "accuracy/probe_cameras.h"
#include "base/device_turn.h"
#include "device_paths/device_tracer.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "reference/scene_problem.h"
#include "reference/trace_rays.h"
#include "reference/trace_scene.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"
#include "volume/visible_box.h"

namespace thunderhead::device_paths {
namespace {

using Fields = std::shared_ptr<const volume::HydrometeorFields>;

Fields SampleStorm() {
  auto store = storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  EXPECT_TRUE(store.ok()) << store.status();
  auto fields = (*store)->Get((*store)->Storms().front()->id, 1, {});
  EXPECT_TRUE(fields.ok()) << fields.status();
  return *std::move(fields);
}

// The mean of several estimates and its standard error.
struct Mean {
  double value = 0.0;
  double standard_error = 0.0;
};

Mean MeanOf(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += value;
  double squares = 0.0;
  for (const double value : values) squares += std::pow(value - sum / count, 2);
  return {sum / count, std::sqrt(squares / count / (count - 1.0))};
}

// A device turn that is always free. It counts how often it is taken, which happens at the start of
// each piece of work.
class CountedTurn final : public base::DeviceTurn {
 public:
  absl::Status Take() override {
    ++taken_;
    return absl::OkStatus();
  }
  void GiveBack() override {}
  int Taken() const { return taken_; }

 private:
  int taken_ = 0;
};

class DevicePaths : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    fields_ = SampleStorm();
    box_ = volume::VisibleBox(*fields_, physics::SizeSource::kModel);
    scene_.camera = accuracy::AroundStorm(box_, 4.0 / 3.0, 2);
    scene_.output = {kWidth_px, kHeight_px, 88};
    options_.peak_cut_deg = 20.0;
    options_.similar = true;
  }

  void Prepare() {
    medium_ = *reference::MediumOf(scene_, *fields_, options_);
    surroundings_ = reference::SurroundingsOf(scene_, *fields_, reference::GroundLight::kShaded);
    surroundings_.disc.reset();
    rays_.clear();
    const reference::Camera camera = reference::CameraOf(scene_, *fields_);
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        rays_.push_back(camera.RayThrough(2.0 * (x + 0.5) / kWidth_px - 1.0,
                                          2.0 * (y + 0.5) / kHeight_px - 1.0));
      }
    }
    auto tracer = DeviceTracer::Create(*medium_, programs_);
    ASSERT_TRUE(tracer.ok()) << tracer.status();
    tracer_ = *std::move(tracer);
  }

  // Compares all colours of all rays, and halves of the picture. Each ray is traced `copies` times
  // with `paths` paths.
  void ExpectAgrees(int copies, int paths, int similar_after) {
    constexpr int kBatches = 24;
    Prepare();
    const std::vector<reference::Ray> once = rays_;
    for (int i = 1; i < copies; ++i) rays_.insert(rays_.end(), once.begin(), once.end());
    std::array<std::vector<double>, 6> here;
    std::array<std::vector<double>, 6> there;
    const auto add = [&](const std::vector<glm::dvec3>& radiance, auto* means) {
      std::array<double, 6> sums{};
      for (std::size_t i = 0; i < radiance.size(); ++i) {
        for (int color = 0; color < 3; ++color) {
          sums[static_cast<std::size_t>(color)] += radiance[i][color];
          sums[i % kPixels < kPixels / 2 ? 3 : 4] += radiance[i][color];
          if (i % kWidth_px < kWidth_px / 2) sums[5] += radiance[i][color];
        }
      }
      for (std::size_t k = 0; k < sums.size(); ++k) (*means)[k].push_back(sums[k]);
    };
    for (int batch = 0; batch < kBatches; ++batch) {
      const reference::TraceRaysOptions trace{.seed = static_cast<std::uint64_t>(batch) << 30U,
                                              .paths_per_ray = paths,
                                              .similar_after = similar_after};
      const auto radiance = tracer_->Trace(surroundings_, rays_, trace);
      ASSERT_TRUE(radiance.ok()) << radiance.status();
      add(*radiance, &there);
      add(*reference::TraceRays(*medium_, surroundings_, rays_, trace), &here);
    }
    for (std::size_t k = 0; k < here.size(); ++k) {
      const Mean expected = MeanOf(here[k]);
      const Mean found = MeanOf(there[k]);
      const double noise = std::hypot(expected.standard_error, found.standard_error);
      EXPECT_LT(noise, 0.02 * expected.value) << "too noisy to compare";
      EXPECT_LT(std::abs(found.value - expected.value), 4.0 * noise) << expected.value;
    }
  }

  static constexpr int kWidth_px = 32;
  static constexpr int kHeight_px = 24;
  static constexpr int kPixels = kWidth_px * kHeight_px;

  std::unique_ptr<gl::Context> context_;
  std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
  Fields fields_;
  volume::WorldBox box_;
  scene::Scene scene_;
  reference::MediumOptions options_;
  std::shared_ptr<const reference::Medium> medium_;
  reference::Surroundings surroundings_;
  std::vector<reference::Ray> rays_;
  std::unique_ptr<DeviceTracer> tracer_;
};

TEST_F(DevicePaths, AgreeWithTheProcessors) { ExpectAgrees(10, 1, 0); }

TEST_F(DevicePaths, AgreeInTheSimilarMedium) { ExpectAgrees(1, 10, 2); }

// The scene has ground, air, and scattering by Henyey and Greenstein's function.
TEST_F(DevicePaths, AgreeFromTheGroundWithASecondLight) {
  scene_.camera = scene::SpotterCamera{.place_m = {box_.low_m.x - 2e4, box_.low_m.y - 2e4},
                                       .eye_height_m = 2.0,
                                       .azimuth_deg = 45.0,
                                       .elevation_deg = 8.0,
                                       .focal_length_mm = 24.0};
  scene_.lights.push_back({.azimuth_deg = 100.0, .elevation_deg = 60.0, .irradiance = 2.0});
  scene_.sun.elevation_deg = 12.0;
  options_.phase = std::make_shared<const reference::SampledPhase>(
      reference::SampledPhase::HenyeyGreenstein(0.5));
  ExpectAgrees(48, 1, 0);
}

TEST_F(DevicePaths, AreTheSameInPieces) {
  Prepare();
  const reference::TraceRaysOptions trace{.seed = 5, .paths_per_ray = 8};
  const auto whole = *tracer_->Trace(surroundings_, rays_, trace);
  EXPECT_EQ(whole, *tracer_->Trace(surroundings_, rays_, trace));
  EXPECT_NE(whole, *tracer_->Trace(surroundings_, rays_, {.seed = 6, .paths_per_ray = 8}));
  CountedTurn turn;
  programs_ = std::make_shared<gl::ProgramCache>(&turn);
  Prepare();
  EXPECT_EQ(whole, *tracer_->Trace(surroundings_, rays_, trace));
  EXPECT_GT(turn.Taken(), 4) << "more than one for each of the tracer's two runs";
}

TEST_F(DevicePaths, OfRaysThatMissAreTheSkys) {
  Prepare();
  surroundings_.air = nullptr;
  surroundings_.shaded_air.reset();
  const reference::Ray up{{0.0, 0.0, 4e4}, glm::normalize(glm::dvec3(0.1, 0.2, 1.0))};
  const auto traced = *tracer_->Trace(surroundings_, {up}, {.paths_per_ray = 3});
  const glm::dvec3 sky = surroundings_.seen_sky(up.direction);
  for (int color = 0; color < 3; ++color) {
    EXPECT_NEAR(traced[0][color], sky[color], 1e-12 * sky[color]);
  }
  EXPECT_TRUE(tracer_->Trace(surroundings_, {}, {})->empty());
}

TEST_F(DevicePaths, EndWhenNobodyWantsThemAnyMore) {
  Prepare();
  int asked = 0;
  reference::TraceRaysOptions trace{.paths_per_ray = 1};
  trace.wanted = [&] {
    return ++asked <= 2 ? absl::OkStatus() : absl::CancelledError("nobody wants it");
  };
  EXPECT_EQ(tracer_->Trace(surroundings_, rays_, trace).status(),
            absl::CancelledError("nobody wants it"));
  EXPECT_EQ(asked, 3);
}

TEST_F(DevicePaths, PeriodicMediaAreNotTraced) {
  const auto slab = *reference::MediumOf(scene_, *fields_, reference::Sides::kPeriodic);
  EXPECT_TRUE(absl::IsUnimplemented(DeviceTracer::Create(*slab, programs_).status()));
}

TEST_F(DevicePaths, AreLeftToTheProcessorsWhereGlIsSoftware) {
  if (TracesOnDevice()) GTEST_SKIP() << "this device traces, or was told to";
  Prepare();
  const auto trace = *TracersFor(programs_)(medium_);
  EXPECT_EQ(*trace(surroundings_, rays_, {.seed = 2}),
            *reference::TraceRays(*medium_, surroundings_, rays_, {.seed = 2}));
}

}  // namespace
}  // namespace thunderhead::device_paths
