// Tests of the measured error. The pictures show a path-traced tower of cloud, and are wrong by a
// known amount.
#include "accuracy/error_meter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "accuracy/error_meters.h"
#include "base/memory_budget.h"
#include "gtest/gtest.h"
#include "measure/image_error.h"
#include "reference/near_sun.h"
#include "reference/scene_problem.h"
#include "reference/trace_scene.h"
#include "tests/support/slab.h"

namespace thunderhead::accuracy {
namespace {

// Returns a tower of cloud in a wider domain with level ground.
std::shared_ptr<volume::HydrometeorFields> MakeTower() {
  auto fields = std::make_shared<volume::HydrometeorFields>(
      *support::MakeSlab(8000.0, 6000.0, 0.02, {20, 20, 15}));
  const volume::RegularGrid& grid = fields->grid;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const bool inside = x >= 6 && x < 14 && y >= 6 && y < 14 && z >= 2 && z < 13;
        if (!inside) fields->fields[0].concentration_kg_per_m3[grid.Offset(x, y, z)] = 0.0F;
      }
    }
  }
  fields->condensate = {{6, 6, 2}, {14, 14, 13}};
  return fields;
}

scene::Scene TowerScene() {
  scene::Scene scene;
  scene.camera = scene::OrbitCamera{.target_m = {0.0, 0.0, 3000.0},
                                    .azimuth_deg = 200.0,
                                    .elevation_deg = 25.0,
                                    .distance_m = 1.5e4,
                                    .field_of_view_deg = 30.0};
  scene.output = {32, 24, 88};
  scene.sun = {255.0, 35.0};
  return scene;
}

picture::LinearPicture ReferenceOf(const scene::Scene& scene,
                                   const volume::HydrometeorFields& fields) {
  scene::Scene reference_scene = scene;
  reference_scene.rendering.technique =
      scene::Reference{.false_colors = scene::FieldLookOf(scene.rendering.technique).false_colors};
  reference::RefineLimits limits;
  limits.samples_per_pixel = 400;
  return reference::TraceScene(reference_scene, fields, reference::TraceOptions{}, limits, {}, {})
      ->image;
}

struct Wrong {
  picture::LinearPicture picture;
  double error = 0.0;
  double bias = 0.0;
};

// Returns the picture with every other block of pixels 40 % too bright and the rest 10 % too dark.
Wrong WrongBy(const picture::LinearPicture& reference) {
  Wrong wrong{reference};
  double squares = 0.0;
  double difference = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < reference.radiance.size(); ++i) {
    const auto width = static_cast<std::size_t>(reference.size_px.x);
    const float factor = (i % width / 4 + i / width / 4) % 2 == 0 ? 1.4F : 0.9F;
    wrong.picture.radiance[i] *= factor;
    for (int color = 0; color < 3; ++color) {
      const double right = reference.radiance[i][color];
      const double noise = reference.standard_error[i][color];
      // The reference itself has noise, and so has the picture made from it.
      squares += std::pow((factor - 1.0) * right, 2) + (2.0 * factor - 1.0) * noise * noise;
      difference += (factor - 1.0) * right;
      sum += right;
    }
  }
  const double count = 3.0 * static_cast<double>(reference.radiance.size());
  wrong.error = std::sqrt(squares / count) / (sum / count);
  wrong.bias = difference / sum;
  return wrong;
}

TEST(ErrorMeter, IntervalsHoldTheErrorOfAPictureThatIsWrongByAKnownAmount) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  const scene::Scene scene = TowerScene();
  const Wrong wrong = WrongBy(ReferenceOf(scene, *fields));
  constexpr int kTrials = 24;
  int held = 0;
  int too_low = 0;
  int held_bias = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto meter =
        *ErrorMeter::Create(scene, fields, 0, static_cast<std::uint64_t>(trial) << 20U);
    meter->Show(wrong.picture);
    for (int step = 0; step < 6; ++step) ASSERT_TRUE(meter->Step().ok());
    const auto error = meter->Result();
    ASSERT_TRUE(error.has_value());
    const auto holds = [](const Estimated& interval, double value) {
      return interval.low <= value && value <= interval.high;
    };
    held += holds(error->relative_rmse, wrong.error) ? 1 : 0;
    too_low += error->relative_rmse.high < wrong.error ? 1 : 0;
    held_bias += holds(error->relative_bias, wrong.bias) ? 1 : 0;
    EXPECT_LT(error->relative_rmse.high - error->relative_rmse.low, wrong.error);
  }
  // 23 of the 24 intervals should contain the error, with a standard deviation of 1.1.
  EXPECT_GE(held, 20) << wrong.error;
  EXPECT_LE(too_low, 3);
  EXPECT_GE(held_bias, 20) << wrong.bias;
}

TEST(ErrorMeter, PathsCountForTheNextPictureToo) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  const scene::Scene scene = TowerScene();
  const picture::LinearPicture reference = ReferenceOf(scene, *fields);
  const Wrong wrong = WrongBy(reference);
  const auto meter = *ErrorMeter::Create(scene, fields, 0);
  meter->Show(wrong.picture);
  for (int step = 0; step < 8; ++step) ASSERT_TRUE(meter->Step().ok());
  const std::int64_t paths = meter->Result()->paths;
  meter->Show(reference);
  EXPECT_EQ(meter->Result()->paths, paths);
  // The picture's only error is its own noise.
  EXPECT_LT(meter->Result()->relative_rmse.low, measure::RelativeNoise(reference));
  EXPECT_LT(meter->Result()->relative_rmse.value, 0.5 * wrong.error);
  picture::LinearPicture smaller{{16, 12}, std::vector<glm::vec3>(192, glm::vec3(0.1F))};
  meter->Show(smaller);
  EXPECT_FALSE(meter->Result().has_value());
}

TEST(ErrorMeter, FalseColorsAreNoError) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  scene::Scene scene = TowerScene();
  scene::MediumSettingsOf(&scene.rendering.technique)->look.false_colors = true;
  const picture::LinearPicture reference = ReferenceOf(scene, *fields);
  const auto meter = *ErrorMeter::Create(scene, fields, 0);
  meter->Show(reference);
  for (int step = 0; step < 8; ++step) ASSERT_TRUE(meter->Step().ok());
  EXPECT_LT(meter->Result()->relative_rmse.low, measure::RelativeNoise(reference));
}

// Returns a scene with the sun just above the tower.
scene::Scene AgainstTheSun() {
  scene::Scene scene = TowerScene();
  auto& camera = std::get<scene::OrbitCamera>(scene.camera);
  camera.azimuth_deg = 75.0;
  camera.elevation_deg = 5.0;
  scene.sun = {255.0, 8.0};
  return scene;
}

TEST(ErrorMeter, TheAureoleThatTheReferenceLeavesOutIsNoError) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  const scene::Scene scene = AgainstTheSun();
  picture::LinearPicture drawn = ReferenceOf(scene, *fields);
  const double noise = measure::RelativeNoise(drawn);
  const std::vector<bool> near_sun =
      reference::NearSun(reference::CameraOf(scene, *fields),
                         scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg),
                         drawn.size_px, reference::kPeakCut_deg);
  const auto brightened = std::ranges::count(near_sun, true);
  EXPECT_GT(brightened, 5);
  EXPECT_LT(brightened, 200);
  for (std::size_t i = 0; i < near_sun.size(); ++i) {
    if (near_sun[i]) drawn.radiance[i] += 1e3F;
  }
  const auto meter = *ErrorMeter::Create(scene, fields, 0);
  meter->Show(drawn);
  ASSERT_TRUE(meter->IsMeasurable());
  for (int step = 0; step < 8; ++step) ASSERT_TRUE(meter->Step().ok());
  EXPECT_LT(meter->Result()->relative_rmse.low, noise);
}

TEST(ErrorMeters, APictureOfHardlyAnythingButTheSunIsNotMeasured) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  scene::Scene scene = AgainstTheSun();
  scene.camera = scene::SpotterCamera{.place_m = {0.0, 2e4},
                                      .eye_height_m = 2.0,
                                      .azimuth_deg = 255.0,
                                      .elevation_deg = 8.0,
                                      .focal_length_mm = 1000.0};
  const ErrorMeters::Draw draw = [](const scene::Scene&) {
    return picture::LinearPicture{{32, 24}, std::vector<glm::vec3>(768, glm::vec3(0.1F))};
  };
  ErrorMeters meters;
  for (int step = 0; step < 3; ++step) {
    const auto progress = meters.Step(scene, fields, 0, draw);
    ASSERT_TRUE(progress.ok()) << progress.status();
    EXPECT_TRUE(progress->ended);
    EXPECT_FALSE(progress->error.has_value());
  }
}

TEST(ErrorMeters, DrawThenTraceAndDrawAgainAsTheLightGetsBetter) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  scene::Scene scene = TowerScene();
  scene.ground = {.cover = scene::GroundCover::kFields, .borders = true, .rings = true};
  int drawn = 0;
  const ErrorMeters::Draw draw = [&](const scene::Scene& measured) {
    ++drawn;
    EXPECT_EQ(measured.ground, (scene::Ground{.cover = scene::GroundCover::kFields}));
    EXPECT_FALSE(scene::MediumSettingsOf(measured.rendering.technique)->look.detail);
    return picture::LinearPicture{{32, 24}, std::vector<glm::vec3>(768, glm::vec3(0.1F))};
  };
  ErrorMeters meters(base::MemoryBudget::Unlimited(), 1);
  EXPECT_EQ(meters.Step(scene, fields, 0, draw)->traced_s, 0.0);
  EXPECT_GT(meters.Step(scene, fields, 0, draw)->traced_s, 0.0);
  EXPECT_EQ(drawn, 1);
  scene.display.exposure_ev = 3.0;  // the light stays the same
  EXPECT_TRUE(meters.Step(scene, fields, 0, draw)->error.has_value());
  EXPECT_EQ(drawn, 1);
  ASSERT_TRUE(meters.Step(scene, fields, 100'000, draw).ok());
  EXPECT_EQ(drawn, 2);
  ASSERT_TRUE(meters.Step(scene, fields, 120'000, draw).ok());
  EXPECT_EQ(drawn, 2);
  const auto again = meters.Step(scene, fields, 200'000, draw);
  EXPECT_EQ(drawn, 3);
  EXPECT_GT(again->error->paths, 0) << "of before";
  scene.sun.elevation_deg += 1.0;
  EXPECT_TRUE(absl::IsResourceExhausted(meters.Step(scene, fields, 0, draw).status()));
}

TEST(ErrorMeters, ReserveTheirCopyOfTheStorm) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  const std::size_t bytes = reference::MediumBytes(*fields, true);
  const auto memory = base::MemoryBudget::Make({.bytes = bytes + bytes / 2});
  const ErrorMeters::Draw draw = [](const scene::Scene&) {
    return picture::LinearPicture{{32, 24}, std::vector<glm::vec3>(768, glm::vec3(0.1F))};
  };
  ErrorMeters meters(memory, 8, 0.0);
  scene::Scene scene = TowerScene();
  ASSERT_TRUE(meters.Step(scene, fields, 0, draw).ok());
  EXPECT_EQ(memory->Used(base::MemoryUse::kTracing), bytes);
  scene.sun.elevation_deg += 1.0;
  const absl::Status refused = meters.Step(scene, fields, 0, draw).status();
  EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
  EXPECT_FALSE(base::IsTooLargeForMemory(refused));
  ASSERT_TRUE(meters.DropOldest());
  EXPECT_EQ(memory->Used(), 0U);
  EXPECT_TRUE(meters.Step(scene, fields, 0, draw).ok());

  ErrorMeters small(base::MemoryBudget::Make({.bytes = bytes - 1}));
  EXPECT_TRUE(base::IsTooLargeForMemory(small.Step(scene, fields, 0, draw).status()));
}

TEST(ErrorMeters, UnevenGroundIsNotMeasured) {
  const std::shared_ptr<volume::HydrometeorFields> fields = MakeTower();
  EXPECT_TRUE(IsMeasurable(*fields));
  fields->terrain_height_m.assign(400, 100.0F);
  EXPECT_TRUE(IsMeasurable(*fields));
  fields->terrain_height_m[7] = 250.0F;
  EXPECT_FALSE(IsMeasurable(*fields));
  ErrorMeters meters;
  const auto progress = meters.Step(TowerScene(), fields, 0, {});
  ASSERT_TRUE(progress.ok());
  EXPECT_TRUE(progress->ended);
  EXPECT_FALSE(progress->error.has_value());
}

}  // namespace
}  // namespace thunderhead::accuracy
