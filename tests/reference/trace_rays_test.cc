#include "reference/trace_rays.h"

#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "comparisons.h"
#include "gtest/gtest.h"
#include "reference/scene_problem.h"
#include "reference/trace_scene.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::reference {
namespace {

using picture::LinearPicture;

class TraceRaysTest : public testing::Test {
 protected:
  TraceRaysTest() {
    scene_.camera = scene::OrbitCamera{.target_m = {0.0, 0.0, 1000.0}, .distance_m = 2e4};
    scene_.output = {8, 6, 88};
    MediumOptions options;
    options.peak_cut_deg = kPeakCut_deg;
    medium_ = *MediumOf(scene_, *fields_, options);
    surroundings_ = SurroundingsOf(scene_, *fields_, GroundLight::kShaded);
    const Camera camera = CameraOf(scene_, *fields_);
    for (int i = 0; i < 200; ++i) rays_.push_back(camera.RayThrough(i / 100.0 - 1.0, 0.05));
  }

  scene::Scene scene_ = test_support::PlainScene();
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(6000.0, 2000.0, 0.002);
  std::shared_ptr<const Medium> medium_;
  Surroundings surroundings_;
  std::vector<Ray> rays_;
};

TEST_F(TraceRaysTest, TheNumberOfThreadsChangesNothing) {
  const auto one = *TraceRays(*medium_, surroundings_, rays_, {5, 3, 1});
  const auto two = *TraceRays(*medium_, surroundings_, rays_, {5, 3, 2});
  EXPECT_EQ(one, two);
  EXPECT_NE(one, *TraceRays(*medium_, surroundings_, rays_, {6, 3, 2}));
}

TEST_F(TraceRaysTest, MeansAreThoseOfThePicture) {
  // Compares with a picture of one pixel so narrow that it is one ray. The tolerance is 5 standard
  // errors of both.
  scene::Scene narrow = scene_;
  auto& camera = std::get<scene::OrbitCamera>(narrow.camera);
  camera.field_of_view_deg = 0.01;
  narrow.output = {1, 1, 88};
  RefineLimits limits;
  limits.samples_per_pixel = 20'000;
  const LinearPicture picture = TraceScene(narrow, *fields_, kPeakCut_deg, limits, {}, {})->image;
  const Ray ray = CameraOf(narrow, *fields_).RayThrough(0.0, 0.0);
  const auto traced = *TraceRays(*medium_, surroundings_, {ray}, {1, 20'000, 0});
  for (int color = 0; color < 3; ++color) {
    EXPECT_NEAR(traced.front()[color], picture.radiance.front()[color],
                5.0 * 1.42 * picture.standard_error.front()[color]);
  }
  EXPECT_GT(traced.front().x, 0.0);
}

// Returns the radiance that a slab reflects straight up, under sunlight from 37 degrees off the
// zenith.
FluxShare Reflected(double optical_depth, double asymmetry, double albedo, int similar_after) {
  constexpr int kRays = 64;
  MediumDescription description = EmptyDescription({1, 1, 1}, {1e5, 1e5, 1000.0});
  description.interpolation = Interpolation::kConstant;
  description.sides = Sides::kPeriodic;
  description.similar = true;
  description.groups.push_back({{static_cast<float>(optical_depth / 1000.0)},
                                glm::dvec3(albedo),
                                HenyeyGreensteinPhase(asymmetry)});
  const auto slab = Made(description);
  Surroundings sun;
  sun.towards_sun = glm::dvec3(0.6, 0.0, 0.8);
  sun.sun_irradiance = glm::dvec3(1.0);
  const std::vector<Ray> rays(kRays, {{0.0, 0.0, slab->High_m().z}, {0.0, 0.0, -1.0}});
  SampleMean mean;
  TraceRaysOptions options{.seed = 3, .paths_per_ray = 400, .similar_after = similar_after};
  const auto traced = *TraceRays(*slab, sun, rays, options);
  for (const glm::dvec3& radiance : traced) mean.Add(radiance.y);
  return mean.Share();
}

// For isotropic scattering the similar medium is the medium itself.
TEST(SimilarPaths, AreThemselvesWhereLightIsScatteredEvenly) {
  EXPECT_EQ(Reflected(10.0, 0.0, 0.95, 3).value, Reflected(10.0, 0.0, 0.95, 0).value);
}

// Tests deep clouds with cloud water's asymmetry, white and absorbing. Each expected value is the
// mean of 4 million exact paths, with a standard error of 0.2 %. Similar paths reflect 1.5 to 1.7 %
// less.
TEST(SimilarPaths, ReflectNearlyAsMuchAsExactOnes) {
  struct Exact {
    double optical_depth;
    double albedo;
    double reflected;
  };
  for (const auto& [optical_depth, albedo, reflected] :
       {Exact{20.0, 1.0, 0.1590}, Exact{60.0, 1.0, 0.2240}, Exact{60.0, 0.99, 0.1214}}) {
    SCOPED_TRACE(reflected);
    ExpectAgrees(Reflected(optical_depth, 0.86, albedo, kSimilarAfter), reflected, 0.02 * reflected,
                 0.015 * reflected);
  }
}

// The purpose of similar paths: exact paths leave more noise.
TEST(SimilarPaths, AreLessNoisy) {
  EXPECT_LT(Reflected(20.0, 0.86, 1.0, kSimilarAfter).standard_error,
            0.7 * Reflected(20.0, 0.86, 1.0, 0).standard_error);
}

TEST_F(TraceRaysTest, NoRaysNoRadiance) {
  EXPECT_TRUE(TraceRays(*medium_, surroundings_, {}, {})->empty());
}

TEST_F(TraceRaysTest, EndsWithinAFewRaysWhenNobodyWantsItAnyMore) {
  constexpr int kWantedFor = 3;
  std::atomic<int> asked{0};
  TraceRaysOptions options{.seed = 1, .paths_per_ray = 1, .threads = 2};
  options.wanted = [&] {
    return ++asked <= kWantedFor ? absl::OkStatus() : absl::CancelledError("nobody wants it");
  };
  const std::vector<Ray> many(100'000, rays_.front());
  const auto traced = TraceRays(*medium_, surroundings_, many, options);
  EXPECT_EQ(traced.status(), absl::CancelledError("nobody wants it"));
  EXPECT_GT(asked, kWantedFor);
  EXPECT_LE(asked, kWantedFor + 2) << "both threads ask no more";
}

}  // namespace
}  // namespace thunderhead::reference
