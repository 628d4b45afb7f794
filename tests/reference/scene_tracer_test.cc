// Tests that a picture traced after changes of the scene equals one traced from scratch.
#include "reference/scene_tracer.h"

#include <atomic>
#include <chrono>
#include <memory>

#include "base/time_source.h"
#include "gtest/gtest.h"
#include "reference/trace_scene.h"
#include "tests/support/techniques.h"

namespace thunderhead::reference {
namespace {

using picture::LinearPicture;

using physics::Hydrometeor;

std::shared_ptr<const volume::HydrometeorFields> TracedStorm() {
  auto fields = std::make_shared<volume::HydrometeorFields>();
  fields->grid = {{8, 7, 6}, {500.0, 400.0, 300.0}, {-2000.0, -1400.0, 100.0}};
  volume::HydrometeorField cloud;
  cloud.hydrometeor = Hydrometeor::kCloud;
  cloud.concentration_kg_per_m3.assign(fields->grid.CellCount(), 0.0F);
  for (int z = 1; z < 5; ++z) {
    for (int x = 2; x < 5; ++x) {
      cloud.concentration_kg_per_m3[fields->grid.Offset(x, 3, z)] = 3e-5F;
    }
  }
  fields->fields = {cloud};
  fields->condensate = {{2, 3, 1}, {5, 4, 5}};
  return fields;
}

scene::Scene SceneFrom(double azimuth_deg) {
  scene::Scene scene = test_support::PlainScene();
  scene.camera = scene::OrbitCamera{
      .target_m = {0.0, 0.0, 1000.0}, .azimuth_deg = azimuth_deg, .distance_m = 6000.0};
  scene.output = {24, 16, 88};
  return scene;
}

RefineLimits Until(int samples_per_pixel) {
  RefineLimits limits;
  limits.samples_per_pixel = samples_per_pixel;
  return limits;
}

LinearPicture AtOnce(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                     int samples) {
  return TraceScene(scene, fields, kPeakCut_deg, Until(samples), {}, {})->image;
}

class SceneTracerTest : public ::testing::Test {
 protected:
  LinearPicture Traced(const scene::Scene& scene,
                       const std::shared_ptr<const volume::HydrometeorFields>& fields) {
    EXPECT_TRUE(tracer_.Begin(scene, fields, {24, 16}).ok());
    EXPECT_EQ(tracer_.Refine(Until(4), {}).end, RefineEnd::kSamples);
    return tracer_.Snapshot();
  }

  SceneTracer tracer_{kPeakCut_deg, {}};
};

TEST_F(SceneTracerTest, EveryChangeIsSeen) {
  const auto storm = TracedStorm();
  scene::Scene scene = SceneFrom(200.0);
  EXPECT_EQ(Traced(scene, storm).radiance, AtOnce(scene, *storm, 4).radiance);
  scene = SceneFrom(80.0);
  EXPECT_EQ(Traced(scene, storm).radiance, AtOnce(scene, *storm, 4).radiance) << "camera";
  scene.sun.elevation_deg = 70.0;
  EXPECT_EQ(Traced(scene, storm).radiance, AtOnce(scene, *storm, 4).radiance) << "sun";
  scene.sky.turbidity = 4.0;
  EXPECT_EQ(Traced(scene, storm).radiance, AtOnce(scene, *storm, 4).radiance) << "sky";
  scene.fields[physics::IndexOf(Hydrometeor::kCloud)].scale = 0.2F;
  EXPECT_EQ(Traced(scene, storm).radiance, AtOnce(scene, *storm, 4).radiance) << "field";
  auto other = std::make_shared<volume::HydrometeorFields>(*storm);
  for (float& value : other->fields[0].concentration_kg_per_m3) value *= 3.0F;
  EXPECT_EQ(Traced(scene, other).radiance, AtOnce(scene, *other, 4).radiance) << "storm";
}

TEST_F(SceneTracerTest, SizesOfAPictureShowTheSameView) {
  const auto storm = TracedStorm();
  const scene::Scene scene = SceneFrom(200.0);
  const auto mean = [&](const glm::ivec2& size_px) {
    EXPECT_TRUE(tracer_.Begin(scene, storm, size_px).ok());
    tracer_.Refine(Until(400 * 384 / (size_px.x * size_px.y)), {});
    glm::dvec3 sum(0.0);
    const LinearPicture image = tracer_.Snapshot();
    for (const glm::vec3& pixel : image.radiance) sum += glm::dvec3(pixel);
    return sum.y / static_cast<double>(image.radiance.size());
  };
  // The standard error of a mean over 153600 paths is below 1 %.
  EXPECT_NEAR(mean({6, 4}) / mean({24, 16}), 1.0, 0.05);
}

// A clock that moves by a millisecond each time it is read.
class CountedLooks final : public base::TimeSource {
 public:
  Clock::time_point Now() const override {
    return Clock::time_point(std::chrono::milliseconds(++looks_));
  }
  Clock::time_point LookAgainAt(Clock::time_point deadline) const override { return deadline; }

 private:
  mutable std::atomic<int> looks_ = 0;
};

// A pause may come at any time, even before every pixel has had its first sample.
TEST_F(SceneTracerTest, PausesChangeNothing) {
  const auto storm = TracedStorm();
  scene::Scene scene = SceneFrom(200.0);
  scene.output = {96, 64, 88};
  ASSERT_TRUE(tracer_.Begin(scene, storm, {96, 64}).ok());
  RefineLimits limits = Until(2);
  // The tracer reads this clock before each of the 6144 pixels. Each call of Refine begins at the
  // first pixel again, so it needs more readings than the call before to reach new pixels. The time
  // before the pause therefore grows with each call.
  const CountedLooks time;
  limits.time = &time;
  int pauses = 0;
  bool paused_within_first_sample = false;
  for (;;) {
    limits.pause_s += 1.5;
    const RefineResult result = tracer_.Refine(limits, {});
    if (result.end == RefineEnd::kSamples) break;
    ASSERT_EQ(result.end, RefineEnd::kPaused);
    paused_within_first_sample =
        paused_within_first_sample || result.progress.samples_per_pixel == 0;
    ++pauses;
  }
  EXPECT_GT(pauses, 1);
  EXPECT_TRUE(paused_within_first_sample);
  EXPECT_EQ(tracer_.Snapshot().radiance, AtOnce(scene, *storm, 2).radiance);
}

}  // namespace
}  // namespace thunderhead::reference
