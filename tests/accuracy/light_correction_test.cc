// Tests of light volumes corrected by traced paths, compared with the reference.
#include <cmath>
#include <memory>
#include <vector>

#include "accuracy/corrector_pool.h"
#include "accuracy/light_corrector.h"
#include "base/memory_budget.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "measure/image_error.h"
#include "measure/light_parts.h"
#include "reference/scene_problem.h"
#include "reference/trace_scene.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::accuracy {
namespace {

using testing::HasSubstr;

// Returns a tower, five times as high as wide, in a wider domain.
std::shared_ptr<const volume::HydrometeorFields> MakeTower() {
  auto fields = std::make_shared<volume::HydrometeorFields>(
      *support::MakeSlab(8000.0, 6000.0, 0.02, {20, 20, 15}));
  const volume::RegularGrid& grid = fields->grid;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const bool inside = x >= 8 && x < 12 && y >= 8 && y < 12 && z >= 2 && z < 13;
        if (!inside) fields->fields[0].concentration_kg_per_m3[grid.Offset(x, y, z)] = 0.0F;
      }
    }
  }
  fields->condensate = {{8, 8, 2}, {12, 12, 13}};
  return fields;
}

class LightCorrection : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kDiffusion);
    std::get<scene::LightVolume>(scene_.rendering.technique).traced_light =
        scene::TracedLight::kAtRest;
    scene_.camera = scene::OrbitCamera{.target_m = {0.0, 0.0, 3000.0},
                                       .azimuth_deg = 200.0,
                                       .elevation_deg = 25.0,
                                       .distance_m = 1.5e4,
                                       .field_of_view_deg = 30.0};
    scene_.output = {32, 24, 88};
    scene_.sun = {255.0, 35.0};
    renderer_ = std::make_unique<renderers::SceneRenderer>();
  }

  picture::LinearPicture Draw(const renderers::DrawQuality& quality) {
    const auto frame = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame::PictureOf(*frame->radiance);
  }

  std::unique_ptr<LightCorrector> MakeCorrector(int threads) {
    auto corrector =
        LightCorrector::Create(scene_, fields_, std::make_shared<gl::ProgramCache>(), threads);
    EXPECT_TRUE(corrector.ok()) << corrector.status();
    return *std::move(corrector);
  }

  std::unique_ptr<gl::Context> context_;
  const std::shared_ptr<gl::ProgramCache> programs_ = std::make_shared<gl::ProgramCache>();
  const std::shared_ptr<TracedLights> lights_ = std::make_shared<TracedLights>();
  std::unique_ptr<renderers::SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ = MakeTower();
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(LightCorrection, MultipliesTheStormsLightAlone) {
  auto correction = std::make_shared<renderers::LightCorrection>();
  correction->size = glm::ivec3(1);
  correction->ground_size = glm::ivec2(1);
  correction->ground.assign(1, glm::vec4(1.0F));
  correction->ground_high_m = {1.0, 1.0};
  const auto draw = [&](const glm::vec3& factor) {
    auto used = std::make_shared<renderers::LightCorrection>(*correction);
    for (int color = 0; color < 3; ++color) {
      used->texels[static_cast<std::size_t>(color)].assign(1, {factor[color], 0.0F, 0.0F, 0.0F});
    }
    renderers::DrawQuality quality;
    quality.single_precision = true;
    quality.correction = used;
    return Draw(quality).radiance;
  };
  renderers::DrawQuality plain;
  plain.single_precision = true;
  const picture::LinearPicture picture = Draw(plain);
  const std::vector<glm::vec3>& drawn = picture.radiance;
  const std::vector<glm::vec3> once = draw(glm::vec3(1.0F));
  const std::vector<glm::vec3> black = draw(glm::vec3(0.0F));
  const std::vector<glm::vec3> twice = draw({2.0F, 1.0F, 0.5F});
  double storm = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const glm::vec3 of_storm = once[i] - black[i];
    storm += of_storm.x;
    for (int color = 0; color < 3; ++color) {
      // A correction also replaces the storm's shade on the skylight that reaches the ground.
      const float background = 1.0F - picture.opacity[i];
      EXPECT_NEAR(once[i][color], drawn[i][color], 1e-6F + 0.1F * background);
      const float factor = color == 0 ? 2.0F : color == 1 ? 1.0F : 0.5F;
      EXPECT_NEAR(twice[i][color] - black[i][color], factor * of_storm[color], 1e-5F);
    }
  }
  EXPECT_GT(storm, 1.0);
}

TEST_F(LightCorrection, SkylightOnTheGroundIsMultipliedWhereItSays) {
  auto correction = std::make_shared<renderers::LightCorrection>();
  correction->size = glm::ivec3(1);
  for (auto& texels : correction->texels) texels.assign(1, {1.0F, 0.0F, 0.0F, 0.0F});
  correction->ground_size = {2, 1};  // two texels; the eastern one is twice as bright
  correction->ground = {glm::vec4(1.0F), glm::vec4(2.0F)};
  correction->ground_low_m = {-1e4, -1e4};
  correction->ground_high_m = {1e4, 1e4};
  scene_.camera = scene::TopDownCamera{.width_m = 4e4};
  const std::vector<glm::vec3> plain = Draw({}).radiance;
  renderers::DrawQuality quality;
  quality.correction = correction;
  const std::vector<glm::vec3> corrected = Draw(quality).radiance;
  const auto gain = [&](int x) {
    const auto i = static_cast<std::size_t>(2 * scene_.output.width_px + x);
    return corrected[i].z / plain[i].z;
  };
  EXPECT_NEAR(gain(2), 1.0F, 2e-3F);
  EXPECT_GT(gain(29), 1.05F);
}

TEST_F(LightCorrection, AFrameSaysWhereItShowsTheStorm) {
  const auto frame = renderer_->Draw(scene_, fields_, {.single_precision = true});
  ASSERT_TRUE(frame.ok()) << frame.status();
  constexpr std::size_t kMiddle = 4 * (12 * 32 + 16);
  const float transmittance = frame::ReadLinear(*frame->storm.radiance)[kMiddle + 3];
  EXPECT_LT(transmittance, 0.1F);
  const double distance_m =
      frame::ReadLinear(*frame->storm.opacity_distance_m)[kMiddle] / (1.0 - transmittance);
  const reference::Ray ray = reference::CameraOf(scene_, *fields_).RayThrough(1.0 / 32, 1.0 / 24);
  const volume::WorldBox& box = frame->storm.box;
  const glm::dvec3 middle = (ray.At(distance_m) - box.low_m) / (box.high_m - box.low_m);
  // The eye is above in the south-south-west and sees the face on that side.
  EXPECT_NEAR(middle.x, 0.4, 0.15);
  EXPECT_LT(middle.y, 0.35);
  EXPECT_GT(middle.z, 0.2);
  EXPECT_LT(middle.z, 0.8);
}

// With a black correction only the light from behind the storm remains.
TEST_F(LightCorrection, WhatIsBehindIsDrawnFromTheSameView) {
  auto black = std::make_shared<renderers::LightCorrection>();
  black->size = glm::ivec3(1);
  for (auto& texels : black->texels) texels.assign(1, glm::vec4(0.0F));
  black->ground_size = glm::ivec2(1);
  black->ground.assign(1, glm::vec4(1.0F));
  black->ground_low_m = glm::dvec2(-1e5);
  black->ground_high_m = glm::dvec2(1e5);
  const auto expected = frame::ReadLinear(
      *renderer_
           ->Draw(scene_, fields_,
                  {.single_precision = true, .correction = black, .sun_seen = false})
           ->radiance);
  auto white = std::make_shared<renderers::LightCorrection>(*black);
  for (auto& texels : white->texels) texels.assign(1, {1.0F, 0.0F, 0.0F, 0.0F});
  const renderers::DrawQuality quality{
      .single_precision = true, .correction = white, .sun_seen = false};
  const auto whole = frame::ReadLinear(*renderer_->Draw(scene_, fields_, quality)->radiance);
  EXPECT_NE(whole, expected);
  const auto behind = renderer_->DrawBehind();
  ASSERT_TRUE(behind.ok()) << behind.status();
  EXPECT_EQ(frame::ReadLinear(*behind->radiance), expected);
  EXPECT_EQ(frame::ReadLinear(*renderer_->Draw(scene_, fields_, quality)->radiance), whole);
}

TEST_F(LightCorrection, TakesMostOfTheErrorAway) {
  reference::RefineLimits limits;
  limits.samples_per_pixel = 600;
  const auto reference =
      reference::TraceScene(scene_, *fields_, reference::kPeakCut_deg, limits, {}, {});
  ASSERT_TRUE(reference.ok()) << reference.status();
  const picture::LinearPicture& exact = reference->image;
  const double noise = measure::RelativeNoise(exact);
  const auto error_of = [&](const picture::LinearPicture& drawn) {
    return measure::RelativeRmseWithout(noise, drawn, exact);
  };
  // Takes means over 4 x 4 rays for each pixel, because the reference's pixels are means too.
  const auto draw = [&](std::shared_ptr<const renderers::LightCorrection> correction) {
    return *measure::DrawPart(*renderer_, scene_, fields_, measure::LightPart::kAll, 4,
                              std::move(correction));
  };
  const picture::LinearPicture drawn = draw(nullptr);
  const auto corrector = MakeCorrector(0);
  EXPECT_EQ(corrector->Correction(), nullptr);
  ASSERT_TRUE(corrector->TraceUntil(150'000, {}, nullptr).ok());
  ASSERT_GE(corrector->Progress().paths, 150'000);
  const picture::LinearPicture corrected = draw(corrector->Correction());
  EXPECT_LT(error_of(corrected), 0.3 * error_of(drawn));
  // Most of the residual is the ground, which is 2 % too bright with and without a correction.
  EXPECT_NEAR(measure::RelativeBias(corrected, exact), 0.0, 0.03);
}

TEST_F(LightCorrection, IsTheSameForAnyNumberOfThreads) {
  const auto one = MakeCorrector(1);
  const auto two = MakeCorrector(2);
  // With this many paths some rays have two paths.
  constexpr std::int64_t kPaths = 2 * kMinCorrectingPaths;
  ASSERT_TRUE(one->TraceUntil(kPaths, {}, nullptr).ok());
  ASSERT_TRUE(two->TraceUntil(kPaths, {}, nullptr).ok());
  EXPECT_EQ(one->Progress().paths, two->Progress().paths);
  EXPECT_EQ(one->Correction()->texels, two->Correction()->texels);
  EXPECT_EQ(one->Correction()->ground, two->Correction()->ground);
}

TEST_F(LightCorrection, FromTheNinthPictureOnARayHasTwoPaths) {
  const auto corrector = MakeCorrector(0);
  while (corrector->Progress().paths == 0) ASSERT_TRUE(corrector->Step().ok());
  for (int picture = 2; picture <= 8; ++picture) ASSERT_TRUE(corrector->Step().ok());
  const std::int64_t of_eight = corrector->Progress().paths;
  for (int picture = 9; picture <= 16; ++picture) ASSERT_TRUE(corrector->Step().ok());
  // The later pictures are seen from other places, so their number of paths is only approximately
  // twice as large.
  EXPECT_NEAR(static_cast<double>(corrector->Progress().paths - of_eight) / of_eight, 2.0, 0.3);
}

// The optical depth is below the limit for drawing.
TEST_F(LightCorrection, AStormTooFaintToBeDrawnEndsWithoutPaths) {
  auto faint = std::make_shared<volume::HydrometeorFields>(*fields_);
  for (float& value : faint->fields[0].concentration_kg_per_m3) value *= 1e-18F;
  fields_ = faint;
  const auto corrector = MakeCorrector(0);
  ASSERT_TRUE(corrector->TraceUntil(kMinCorrectingPaths, {}, nullptr).ok());
  EXPECT_EQ(corrector->Progress().paths, 0);
  EXPECT_EQ(corrector->Correction(), nullptr);
}

TEST_F(LightCorrection, FewPathsCorrectNothing) {
  const auto corrector = MakeCorrector(0);
  while (corrector->Progress().paths < kMinCorrectingPaths) {
    EXPECT_EQ(corrector->Correction(), nullptr) << corrector->Progress().paths << " paths";
    ASSERT_TRUE(corrector->Step().ok());
  }
  EXPECT_GT(corrector->Progress().steps, 18) << "several pictures";
  EXPECT_NE(corrector->Correction(), nullptr);
}

TEST_F(LightCorrection, ServesScenesOfTheSameLight) {
  const auto corrector = MakeCorrector(0);
  scene::Scene other = scene_;
  other.camera = scene::TopDownCamera{};
  other.display.exposure_ev = 2.0;
  other.output.width_px = 100;
  EXPECT_TRUE(corrector->Serves(other, fields_));
  EXPECT_FALSE(corrector->Serves(other, MakeTower()));
  other.sun.azimuth_deg += 1.0;
  EXPECT_FALSE(corrector->Serves(other, fields_));
  other = scene_;
  other.sky.brightness = 0.5;
  EXPECT_FALSE(corrector->Serves(other, fields_));
  other = scene_;
  other.fields[0].scale = 2.0F;
  EXPECT_FALSE(corrector->Serves(other, fields_));
}

TEST_F(LightCorrection, APoolKeepsWhatIsTracedAndRefusesOneTooMany) {
  CorrectorPool pool(programs_, lights_, base::MemoryBudget::Unlimited(), 1, 1e9);
  EXPECT_EQ(pool.Find(scene_, fields_), nullptr);
  const auto progress = pool.Trace(scene_, fields_);
  ASSERT_TRUE(progress.ok()) << progress.status();
  EXPECT_EQ(progress->steps, 1);
  ASSERT_NE(pool.Find(scene_, fields_), nullptr);
  EXPECT_EQ(pool.Find(scene_, fields_)->Progress().steps, 1);
  scene::Scene other = scene_;
  other.sun.elevation_deg = 70.0;
  EXPECT_THAT(std::string(pool.Trace(other, fields_).status().message()),
              HasSubstr("the light of 1 other scenes already"));
  EXPECT_EQ(pool.Trace(scene_, fields_)->steps, 2);
  CorrectorPool idle(programs_, lights_, base::MemoryBudget::Unlimited(), 1, 0.0);
  ASSERT_TRUE(idle.Trace(scene_, fields_).ok());
  ASSERT_TRUE(idle.Trace(other, fields_).ok());
  EXPECT_EQ(idle.Find(scene_, fields_), nullptr);
  EXPECT_NE(idle.Find(other, fields_), nullptr);
}

TEST_F(LightCorrection, APoolReservesItsCopiesOfTheStorm) {
  const std::size_t bytes = reference::MediumBytes(*fields_, true);
  const auto memory = base::MemoryBudget::Make({.bytes = bytes + bytes / 2});
  CorrectorPool pool(programs_, lights_, memory, 8, 0.0);
  LightClaim claim;
  ASSERT_TRUE(pool.Trace(scene_, fields_, &claim).ok());
  EXPECT_EQ(memory->Used(base::MemoryUse::kTracing), bytes);
  scene::Scene other = scene_;
  other.sun.elevation_deg = 70.0;
  EXPECT_TRUE(absl::IsResourceExhausted(pool.Trace(other, fields_).status()));
  EXPECT_NE(pool.Find(scene_, fields_), nullptr);
  // Without its claim, the first corrector can be evicted to make space for another.
  claim.reset();
  EXPECT_TRUE(pool.Trace(other, fields_).ok());
  EXPECT_EQ(pool.Find(scene_, fields_), nullptr);
  EXPECT_EQ(memory->Used(), bytes);
}

TEST_F(LightCorrection, AStormThatNeverFitsDropsNoOther) {
  const std::size_t bytes = reference::MediumBytes(*fields_, true);
  const auto memory = base::MemoryBudget::Make({.bytes = bytes});
  CorrectorPool pool(programs_, lights_, memory, 8, 0.0);
  ASSERT_TRUE(pool.Trace(scene_, fields_).ok());
  auto large = std::make_shared<volume::HydrometeorFields>(*fields_);
  large->grid.cells.z *= 2;
  EXPECT_TRUE(absl::IsResourceExhausted(pool.Trace(scene_, large).status()));
  EXPECT_NE(pool.Find(scene_, fields_), nullptr);
}

TEST_F(LightCorrection, APoolKeepsWhatIsClaimed) {
  CorrectorPool pool(programs_, lights_, base::MemoryBudget::Unlimited(), 1, 0.0, 0.0);
  LightClaim claim;
  ASSERT_TRUE(pool.Trace(scene_, fields_, &claim).ok());
  scene::Scene other = scene_;
  other.sun.elevation_deg = 70.0;
  EXPECT_TRUE(absl::IsResourceExhausted(pool.Trace(other, fields_).status()));
  EXPECT_EQ(pool.Trace(scene_, fields_, &claim)->steps, 2);
  claim.reset();
  EXPECT_TRUE(pool.Trace(other, fields_).ok());
  EXPECT_EQ(pool.Find(scene_, fields_), nullptr);
}

TEST_F(LightCorrection, NothingIsTracedWhereNothingCouldShowIt) {
  CorrectorPool pool(programs_);
  scene::Scene scene = scene_;
  std::get<scene::LightVolume>(scene.rendering.technique).traced_light = scene::TracedLight::kOff;
  EXPECT_EQ(pool.Trace(scene, fields_)->steps, 0);
  scene = scene_;
  test_support::SetTransport(&scene.rendering.technique, scene::Transport::kConsistent);
  EXPECT_EQ(pool.Trace(scene, fields_)->steps, 0);
  scene = scene_;
  test_support::SetMode(&scene.rendering.technique, test_support::kLowAlbedo);
  EXPECT_EQ(pool.Trace(scene, fields_)->steps, 0);
  scene = scene_;
  for (scene::FieldParameters& field : scene.fields) field.visible = false;
  EXPECT_EQ(pool.Trace(scene, fields_)->steps, 0);
  auto empty = std::make_shared<volume::HydrometeorFields>(*MakeTower());
  empty->condensate = {};
  empty->fields[0].concentration_kg_per_m3.clear();
  EXPECT_EQ(pool.Trace(scene_, empty)->steps, 0);
}

TEST_F(LightCorrection, WhereHardlyAnyRayMeetsTheStormItEnds) {
  // The storm is so thin that the background dominates everywhere.
  scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].scale = 1e-3F;
  const auto corrector = MakeCorrector(0);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(corrector->Step().ok());
  EXPECT_EQ(corrector->Progress().paths, 0);
  EXPECT_EQ(corrector->Correction(), nullptr);
  EXPECT_TRUE(corrector->Progress().HasTraced(5'000));
  EXPECT_FALSE(corrector->Progress().HasTraced(10'000));
}

TEST_F(LightCorrection, NightAndBlackSkiesStayDark) {
  scene_.sun.elevation_deg = -60.0;
  scene_.sky.brightness = 0.0;
  const auto corrector = MakeCorrector(0);
  ASSERT_TRUE(corrector->TraceUntil(kMinCorrectingPaths, {}, nullptr).ok());
  renderers::DrawQuality quality;
  quality.correction = corrector->Correction();
  ASSERT_NE(quality.correction, nullptr);
  for (const glm::vec3& pixel : Draw(quality).radiance) {
    EXPECT_GE(pixel.x, 0.0F);
    EXPECT_LT(pixel.x, 1e-3F);
  }
}

}  // namespace
}  // namespace thunderhead::accuracy
