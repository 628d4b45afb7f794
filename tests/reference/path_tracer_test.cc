#include "reference/path_tracer.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>

#include "comparisons.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "gmock/gmock.h"
#include "picture/exr_file.h"

namespace thunderhead::reference {
namespace {

using picture::LinearPicture;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns a camera with parallel rays in `direction` through the whole top face.
Camera OverTheTop(const Medium& medium, const glm::dvec3& direction) {
  const glm::dvec3 half = 0.5 * (medium.High_m() - medium.Low_m());
  const glm::dvec3 middle_m = medium.Low_m() + half * glm::dvec3(1.0, 1.0, 2.0);
  return Camera::Parallel(middle_m, {half.x, 0.0, 0.0}, {0.0, half.y, 0.0}, direction);
}

Surroundings SunOnly(const glm::dvec3& towards_sun) {
  Surroundings around;
  around.towards_sun = towards_sun;
  around.sun_irradiance = glm::dvec3(1.0);
  return around;
}

// Returns the mean of one colour over an image whose pixels all estimate parts of the same mean.
FluxShare MeanOf(const LinearPicture& image, int color) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    sum += image.radiance[i][color];
    squares += std::pow(image.standard_error[i][color], 2);
  }
  const auto pixels = static_cast<double>(image.radiance.size());
  return {sum / pixels, std::sqrt(squares) / pixels};
}

LinearPicture Trace(std::shared_ptr<const Medium> medium, const Surroundings& around,
                    const Camera& camera, const glm::ivec2& size_px, int samples) {
  PathTracer tracer(std::move(medium), around, camera, size_px, {});
  RefineLimits limits;
  limits.samples_per_pixel = samples;
  tracer.Refine(limits, {}, {});
  return tracer.Snapshot();
}

// Compares the upward radiance at the top of DISORT's test 3 (optical depth 8), where the sun's
// flux is pi.
TEST(PathTracer, UpwardRadianceOfDisortTest3) {
  struct Published {
    double mu;
    double radiance;
  };
  const auto slab = Slab(8.0, 0.75, 1.0);
  for (const auto& [mu, radiance] :
       {Published{0.1, 0.379740}, Published{0.5, 0.519598}, Published{1.0, 0.493302}}) {
    SCOPED_TRACE(mu);
    const glm::dvec3 down(std::sqrt(1.0 - mu * mu), 0.0, -mu);
    const LinearPicture image =
        Trace(slab, SunOnly(SunAt(0.0)), OverTheTop(*slab, down), {16, 16}, 900);
    FluxShare share = MeanOf(image, 1);
    share.value *= std::numbers::pi;
    share.standard_error *= std::numbers::pi;
    ExpectAgrees(share, radiance, 5e-7, 2.5e-3);
  }
}

// Furnace test: under uniform light from all directions a medium that does not absorb is invisible.
// If paths are too short for Russian roulette, every path returns exactly that light.
TEST(PathTracer, WhiteFurnace) {
  constexpr glm::dvec3 kLight(0.7, 1.0, 3.0);
  Surroundings furnace;
  furnace.sky = [=](const glm::dvec3&) { return kLight; };
  for (const double densest_per_m : {1e-3, 0.05, 1.0}) {
    SCOPED_TRACE(densest_per_m);
    const auto cloud = Made(LumpyCloud(densest_per_m, 1.0, 0.85));
    scene::View view;
    view.eye_m = 0.5 * (cloud->Low_m() + cloud->High_m()) - glm::dvec3(0.0, 1500.0, 0.0);
    view.tan_half_width = view.tan_half_height = 0.5;
    const LinearPicture image = Trace(cloud, furnace, Camera::Of(view), {24, 24}, 64);
    for (int color = 0; color < 3; ++color) {
      ExpectAgrees(MeanOf(image, color), kLight[color], 1e-6, 5e-3 * kLight[color]);
    }
    if (densest_per_m > 1e-3) continue;
    for (const glm::vec3& radiance : image.radiance) EXPECT_NEAR(radiance.z, 3.0F, 4e-6F);
  }
}

// Colours whose phase functions differ share their paths. Each must have the result it would have
// alone, even after hundreds of scatterings.
TEST(PathTracer, ColorsOfDifferentPhaseFunctions) {
  constexpr std::array<double, 3> kAsymmetries = {0.85, 0.75, 0.2};
  const auto formula = [](double g) {
    return [g](double mu) { return (1.0 - g * g) / std::pow(1.0 + g * g - 2.0 * g * mu, 1.5); };
  };
  const SampledPhase colored = SampledPhase::Tabulated(std::array<SampledPhase::Function, 3>{
      formula(kAsymmetries[0]), formula(kAsymmetries[1]), formula(kAsymmetries[2])});
  const auto look = [](const SampledPhase& phase) {
    auto slab = SlabMedium(20.0, phase, 1.0);
    EXPECT_TRUE(slab.ok()) << slab.status();
    return Trace(*slab, SunOnly(SunAt(60.0)), OverTheTop(**slab, {0.6, 0.0, -0.8}), {16, 16}, 400);
  };
  const LinearPicture together = look(colored);
  for (std::size_t color = 0; color < 3; ++color) {
    const LinearPicture alone = look(SampledPhase::HenyeyGreenstein(kAsymmetries[color]));
    ExpectAgree(MeanOf(together, static_cast<int>(color)), MeanOf(alone, 0), 0.006);
  }
  Surroundings furnace;
  furnace.sky = [](const glm::dvec3&) { return glm::dvec3(1.0); };
  auto slab = SlabMedium(20.0, colored, 1.0);
  const LinearPicture white =
      Trace(*slab, furnace, OverTheTop(**slab, {0.6, 0.0, -0.8}), {16, 16}, 400);
  for (int color = 0; color < 3; ++color) ExpectAgrees(MeanOf(white, color), 1.0, 0.0, 0.006);
}

// Two lights together give the sum of each alone, each in its own colour. A light in the sun's
// place acts as the sun, except that it does not light the ground.
TEST(PathTracer, LightsAddUp) {
  const auto cloud = Made(LumpyCloud(0.02, 1.0, 0.5));
  const auto look = [&](const std::vector<DirectionalLight>& lights, const Surroundings& around) {
    Surroundings with = around;
    with.lights = lights;
    return Trace(cloud, with, OverTheTop(*cloud, {0.6, 0.0, -0.8}), {16, 16}, 400);
  };
  const DirectionalLight red{SunAt(50.0), {1.0, 0.0, 0.0}};
  const DirectionalLight white{{-0.6, 0.0, 0.8}, glm::dvec3(0.5)};
  const LinearPicture both = look({red, white}, {});
  const LinearPicture sun = look({}, SunOnly(SunAt(50.0)));
  const LinearPicture second = look({white}, {});
  ExpectAgree(MeanOf(both, 1), MeanOf(second, 1), 0.01);
  const FluxShare first = MeanOf(sun, 0);
  const FluxShare other = MeanOf(second, 0);
  ExpectAgree(MeanOf(both, 0),
              {first.value + other.value, std::hypot(first.standard_error, other.standard_error)},
              0.01);
  EXPECT_GT(first.value, 0.02);
  EXPECT_GT(other.value, 0.02);
}

// Runs the furnace test with a white Lambertian ground below.
TEST(PathTracer, WhiteFurnaceWithGround) {
  Surroundings furnace;
  furnace.sky = [](const glm::dvec3&) { return glm::dvec3(1.0); };
  const auto cloud = Made(LumpyCloud(0.02, 1.0, 0.5));
  furnace.ground = Ground{cloud->Low_m().z, glm::dvec3(1.0), glm::dvec3(0.0)};
  const LinearPicture image =
      Trace(cloud, furnace, OverTheTop(*cloud, {0.6, 0.0, -0.8}), {16, 16}, 64);
  ExpectAgrees(MeanOf(image, 1), 1.0, 1e-6, 5e-3);
}

// Russian roulette keeps the mean of an absorbing medium unbiased: rays through a purely absorbing
// slab see the attenuated sky.
TEST(PathTracer, AbsorbingSlabInFurnace) {
  Surroundings furnace;
  furnace.sky = [](const glm::dvec3&) { return glm::dvec3(1.0); };
  const auto slab = Slab(1.5, 0.0, 0.0);
  const LinearPicture image =
      Trace(slab, furnace, OverTheTop(*slab, {0.6, 0.0, -0.8}), {16, 16}, 400);
  ExpectAgrees(MeanOf(image, 0), std::exp(-1.5 / 0.8), 0.0, 2e-3);
}

double OpticalDepth(const Medium& medium, const Ray& ray) {
  constexpr int kSteps = 400;
  const RayInterval interval = Clip(medium, ray, kInfinity);
  const double step_m = std::max(interval.end_m - interval.begin_m, 0.0) / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    sum += medium.Extinction_per_m(ray.At(interval.begin_m + (i + 0.5) * step_m));
  }
  return sum * step_m;
}

// A lumpy cloud of optical depth up to 1 absorbs nearly all light. Only single scattering remains,
// which is computed here by quadrature along the ray. Double scattering adds at most the albedo, 1
// %, times the ratio of phase functions, below 3.
TEST(PathTracer, SingleScatteringByQuadrature) {
  constexpr double kAlbedo = 0.01;
  const auto cloud = Made(LumpyCloud(0.003, kAlbedo, 0.3));
  const Surroundings around = SunOnly(SunAt(50.0));
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, 0.8, -0.2));
  const glm::dvec3 eye_m = cloud->Low_m() + glm::dvec3(200.0, -100.0, 250.0);
  const Camera camera = Camera::Parallel(eye_m, {}, {}, direction);
  const LinearPicture image = Trace(cloud, around, camera, {64, 64}, 600);

  const Ray ray{eye_m, direction};
  const RayInterval interval = Clip(*cloud, ray, kInfinity);
  constexpr int kSteps = 2000;
  const double step_m = (interval.end_m - interval.begin_m) / kSteps;
  double depth = 0.0;
  double expected = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const glm::dvec3 point_m = ray.At(interval.begin_m + (i + 0.5) * step_m);
    const double extinction = cloud->Extinction_per_m(point_m);
    const double to_sun = OpticalDepth(*cloud, {point_m, around.towards_sun});
    expected += extinction * step_m * std::exp(-depth - 0.5 * extinction * step_m - to_sun);
    depth += extinction * step_m;
  }
  const double phase =
      SampledPhase::HenyeyGreenstein(0.3).Value(glm::dot(direction, around.towards_sun)).x;
  expected *= kAlbedo * phase / (4.0 * std::numbers::pi);
  ASSERT_GT(depth, 0.2);
  ExpectAgrees(MeanOf(image, 0), expected, 0.03 * expected, 0.02 * expected);
}

// With one scattering allowed, the radiance that a slab reflects has a closed form, the integral of
// single scattering over the slab. The sun's flux F0 is 1.
TEST(PathTracer, LightScatteredOnceIsTheClosedForm) {
  constexpr double kDepth = 2.0;
  constexpr double kAsymmetry = 0.5;
  const auto slab = Slab(kDepth, kAsymmetry, 1.0);
  for (const double mu : {0.4, 1.0}) {
    SCOPED_TRACE(mu);
    const glm::dvec3 down(std::sqrt(1.0 - mu * mu), 0.0, -mu);
    PathTracerOptions options;
    options.max_scatterings = 1;
    PathTracer tracer(slab, SunOnly(SunAt(0.0)), OverTheTop(*slab, down), {16, 16}, options);
    RefineLimits limits;
    limits.samples_per_pixel = 4000;
    tracer.Refine(limits, {}, {});
    const double g = kAsymmetry;
    const double phase = (1.0 - g * g) / std::pow(1.0 + g * g + 2.0 * g * mu, 1.5);
    const double expected =
        phase / (4.0 * std::numbers::pi) / (1.0 + mu) * -std::expm1(-kDepth * (1.0 / mu + 1.0));
    ExpectAgrees(MeanOf(tracer.Snapshot(), 1), expected, 0.0, 2e-3 * expected);
  }
}

// Tests the thin limit with albedo 1: twice scattered light is of relative order of the optical
// depth, 0.004 along the slanted paths.
TEST(PathTracer, ThinLimit) {
  const double depth = 1e-3;
  const auto slab = Slab(depth, 0.75, 1.0);
  const glm::dvec3 down(0.6, 0.0, -0.8);
  const glm::dvec3 towards_sun = SunAt(60.0);
  const LinearPicture image =
      Trace(slab, SunOnly(towards_sun), OverTheTop(*slab, down), {64, 64}, 1000);
  const double phase = SampledPhase::HenyeyGreenstein(0.75).Value(glm::dot(down, towards_sun)).x;
  const double expected = phase / (4.0 * std::numbers::pi) * depth / 0.8;
  ExpectAgrees(MeanOf(image, 1), expected, 0.01 * expected, 0.02 * expected);
}

// Helmholtz reciprocity: the domain's mean radiance over the sunlight on its top stays the same
// when sun and eye are exchanged. The medium is a steep-walled, periodic chessboard.
TEST(PathTracer, Reciprocity) {
  const auto board = Made(Chessboard(2.0 / 250.0, 18.0 / 250.0, 0.99, 0.7));
  const glm::dvec3 a = SunAt(60.0);
  const glm::dvec3 b = glm::normalize(glm::dvec3(-0.3, 0.5, 0.6));
  const auto reflected = [&](const glm::dvec3& towards_sun, const glm::dvec3& towards_eye) {
    const LinearPicture image =
        Trace(board, SunOnly(towards_sun), OverTheTop(*board, -towards_eye), {32, 32}, 200);
    FluxShare share = MeanOf(image, 0);
    share.value /= towards_sun.z;
    share.standard_error /= towards_sun.z;
    return share;
  };
  const FluxShare forth = reflected(a, b);
  EXPECT_GT(forth.value, 0.05);
  ExpectAgree(forth, reflected(b, a), 0.02 * forth.value);
}

LinearPicture SmallPicture(int threads, const std::vector<int>& passes) {
  const auto cloud = Made(LumpyCloud(0.05, 0.97, 0.85));
  Surroundings around = SunOnly(SunAt(40.0));
  around.sky = [](const glm::dvec3& direction) { return glm::dvec3(0.1 + 0.05 * direction.z); };
  around.ground = Ground{cloud->Low_m().z - 100.0, {0.2, 0.3, 0.4}, glm::dvec3(0.0)};
  PathTracerOptions options;
  options.threads = threads;
  options.seed = 99;
  PathTracer tracer(cloud, around, OverTheTop(*cloud, {0.6, 0.0, -0.8}), {37, 21}, options);
  for (const int until : passes) {
    RefineLimits limits;
    limits.samples_per_pixel = until;
    EXPECT_EQ(tracer.Refine(limits, {}, {}).end, RefineEnd::kSamples);
  }
  return tracer.Snapshot();
}

TEST(PathTracer, SameForAnyNumberOfThreadsAndPasses) {
  const LinearPicture image = SmallPicture(1, {24});
  for (const LinearPicture& other :
       {SmallPicture(2, {24}), SmallPicture(5, {24}), SmallPicture(2, {3, 4, 24})}) {
    EXPECT_EQ(image.radiance, other.radiance);
    EXPECT_EQ(image.standard_error, other.standard_error);
  }
}

// Pixels with the same mean vary about it as their standard errors predict.
TEST(PathTracer, StandardErrorsAreHonest) {
  const auto slab = Slab(4.0, 0.5, 0.9);
  const LinearPicture image =
      Trace(slab, SunOnly(SunAt(30.0)), OverTheTop(*slab, {0.6, 0.0, -0.8}), {32, 32}, 100);
  const double mean = MeanOf(image, 0).value;
  double chi_squared = 0.0;
  for (std::size_t i = 0; i < image.radiance.size(); ++i) {
    chi_squared += std::pow((image.radiance[i].x - mean) / image.standard_error[i].x, 2);
  }
  // Errors are estimated from 100 samples of a skewed quantity, so the ratio is known to about 5 %.
  EXPECT_NEAR(chi_squared / static_cast<double>(image.radiance.size()), 1.0,
              4.0 * std::sqrt(2.0 / 1024.0) + 0.05);
}

PathTracer SlabTracer(const glm::ivec2& size_px) {
  const auto slab = Slab(1.0, 0.75, 1.0);
  return {slab, SunOnly(SunAt(30.0)), OverTheTop(*slab, {0.0, 0.0, -1.0}), size_px, {}};
}

TEST(PathTracer, StopsAtRelativeError) {
  PathTracer tracer = SlabTracer({8, 8});
  RefineLimits limits;
  limits.relative_error = 0.05;
  const RefineResult result = tracer.Refine(limits, {}, {});
  EXPECT_EQ(result.end, RefineEnd::kRelativeError);
  EXPECT_LE(result.progress.relative_error, 0.05);
  EXPECT_GE(result.progress.relative_error, 0.04);  // it stops once the request is met
}

TEST(PathTracer, StopsAfterTheTimeGivenButNotBeforeOneSample) {
  PathTracer tracer = SlabTracer({64, 64});
  RefineLimits limits;
  limits.seconds = 1e-6;
  const RefineResult first = tracer.Refine(limits, {}, {});
  EXPECT_EQ(first.end, RefineEnd::kSeconds);
  EXPECT_EQ(first.progress.samples_per_pixel, 1);
  EXPECT_EQ(first.progress.relative_error, kInfinity);
  limits.seconds = 0.1;
  const RefineResult second = tracer.Refine(limits, {}, {});
  EXPECT_EQ(second.end, RefineEnd::kSeconds);
  EXPECT_GT(second.progress.samples_per_pixel, 1);
}

TEST(PathTracer, StopsWhenAskedAndGoesOn) {
  PathTracer tracer = SlabTracer({16, 16});
  std::stop_source stop;
  const auto at_ten = [&](const ImageProgress& progress) {
    if (progress.samples_per_pixel >= 10) stop.request_stop();
  };
  const RefineResult result = tracer.Refine({}, at_ten, stop.get_token());
  EXPECT_EQ(result.end, RefineEnd::kStopped);
  EXPECT_GE(result.progress.samples_per_pixel, 10);
  RefineLimits limits;
  limits.samples_per_pixel = 40;
  EXPECT_EQ(tracer.Refine(limits, {}, {}).progress.samples_per_pixel, 40);
}

TEST(PathTracer, Extremes) {
  for (const double optical_depth : {0.0, 1e-8, 1.0, 1e4}) {
    for (const double zenith_deg : {0.0, 60.0, 90.0, 100.0}) {
      Surroundings around = SunOnly(SunAt(zenith_deg));
      around.sky = [](const glm::dvec3&) { return glm::dvec3(0.5); };
      const auto slab = Slab(optical_depth, 0.85, 0.999);
      const LinearPicture image =
          Trace(slab, around, OverTheTop(*slab, {0.0, 0.0, -1.0}), {8, 8}, 4);
      for (const glm::vec3& radiance : image.radiance) {
        EXPECT_TRUE(std::isfinite(radiance.x) && radiance.x >= 0.0F) << optical_depth;
      }
      // Hardly any of the even sky's light is absorbed.
      EXPECT_GT(MeanOf(image, 0).value, 0.3) << optical_depth << ' ' << zenith_deg;
    }
  }
}

TEST(ExrFile, RoundTrip) {
  const LinearPicture image = SmallPicture(2, {4});
  const std::string path = testing::TempDir() + "reference_round_trip.exr";
  ASSERT_TRUE(picture::WriteExr(path, image).ok());
  const auto read = picture::ReadExr(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->size_px, image.size_px);
  EXPECT_EQ(read->radiance, image.radiance);
  EXPECT_EQ(read->standard_error, image.standard_error);
  EXPECT_FALSE(read->opacity.empty());
  EXPECT_EQ(read->opacity, image.opacity);
}

TEST(ExrFile, SaysWhatIsWrong) {
  const LinearPicture image = SmallPicture(2, {2});
  const absl::Status status = picture::WriteExr("/nonexistent-folder/image.exr", image);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(status.message().find("/nonexistent-folder/image.exr"), std::string::npos);
  EXPECT_FALSE(picture::ReadExr("/nonexistent-folder/image.exr").ok());
}

// Returns an EXR file whose header claims another size than its picture has.
std::string ExrThatClaims(const glm::ivec2& size_px) {
  std::string exr = *picture::EncodeExr(SmallPicture(2, {2}));
  // The attribute is its name, type and size, then the window's first and last pixel.
  using std::string_literals::operator""s;
  const std::string before = "dataWindow\0box2i\0\x10\0\0\0"s;
  const glm::ivec2 last_px = size_px - 1;
  std::memcpy(exr.data() + exr.find(before) + before.size() + sizeof(last_px), &last_px,
              sizeof(last_px));
  return exr;
}

TEST(ExrFile, APictureLargerThanItsFileIsRefusedBeforeItsMemoryIsAllocated) {
  const auto message = [](const glm::ivec2& size_px) {
    const absl::Status status = picture::DecodeExr(ExrThatClaims(size_px), "a.exr").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return std::string(status.message());
  };
  EXPECT_THAT(message({60'000, 1000}),
              HasSubstr("too few for its 60000 x 1000 pixels; give a complete file"));
  EXPECT_THAT(message({500'000'000, 8}),
              AllOf(HasSubstr("exceeds the maximum width"), Not(HasSubstr("bad_alloc"))));
}

}  // namespace
}  // namespace thunderhead::reference
