// Tests of the slicing renderer against closed forms: single scattering in a homogeneous box, the
// printed transport of the paper, and limits that hold for every optical depth. The paper is Riley
// et al. 2003 (Vis).
#include <cmath>
#include <numbers>

#include "gtest/gtest.h"
#include "physics/optics.h"
#include "tests/accuracy/slab_view.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

class HalfAngle : public SlabView {
 protected:
  void SetUp() override {
    test_support::SetTechnique(&scene_.rendering.technique, test_support::kHalfAngle);
  }
};

// Returns the error bound at the slab's hard faces, which cut tilted slices. The path of a ray, and
// that of the light, consists of whole slices, with an error of up to half a slice at each face. At
// the steepest tilt that is tested, the slab's thickness is 1 / 2.5 of the sliced extent. Storms
// have no hard faces: their extinction falls to zero linearly over a cell.
double HardFaceError(int slices, double depth) { return 3.3 * (1.0 + depth / 2.0) / slices; }

class SingleScattering : public HalfAngle {
 protected:
  void SetUp() override {
    HalfAngle::SetUp();
    test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
    test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kConsistent);
    SetPhase(physics::PhaseKind::kCornetteShanks, 0.0F);
  }
};

TEST_F(SingleScattering, ReflectedLightOfASlab) {
  // With sun and eye above, the result is the integral of exp(-t (1 / sin e + 1 / sin s)) dt / sin
  // e.
  for (const int slices : {64, 256}) {
    scene::SetSlices(&scene_.rendering.technique, slices);
    for (const double depth : {0.01, 0.5, 3.0, 20.0}) {
      for (const auto& [view_deg, sun_deg] :
           {std::pair(89.9, 89.9), std::pair(88.0, 45.0), std::pair(50.0, 60.0)}) {
        const double view = 1.0 / std::sin(view_deg * std::numbers::pi / 180);
        const double sun = 1.0 / std::sin(sun_deg * std::numbers::pi / 180);
        const double expected =
            PhaseTerm(view_deg, sun_deg) * view * -std::expm1(-depth * (view + sun)) / (view + sun);
        const Seen seen = Look(depth, view_deg, sun_deg);
        // The first pair of angles is sliced along the slab's faces, within 0.4 % of its extent.
        const double error =
            view_deg == sun_deg ? 0.004 * (1.0 + depth / 4) : HardFaceError(slices, depth);
        EXPECT_NEAR(seen.radiance / expected, 1.0, kTextureError + error)
            << slices << " slices, depth " << depth << ", view " << view_deg << ", sun " << sun_deg;
        EXPECT_NEAR(seen.transmittance, std::exp(-depth * view),
                    (kTextureError + error) * std::min(depth * view, 1.0));
      }
    }
  }
}

TEST_F(SingleScattering, SeenFromAboveWithoutPerspective) {
  // Every pixel over the slab looks straight down, so the integral above holds in all of them.
  scene::TopDownCamera camera;
  camera.width_m = 1000.0;
  const scene::View view = scene::ViewOf(camera, 1.0);
  for (const double depth : {0.01, 0.5, 3.0}) {
    const double sun = 1.0 / std::sin(60.0 * std::numbers::pi / 180);
    const double expected = PhaseTerm(90.0, 60.0) * -std::expm1(-depth * (1.0 + sun)) / (1.0 + sun);
    const Seen seen = Look(depth, view, 60.0);
    const double error =
        kTextureError + HardFaceError(*scene::SlicesOf(scene_.rendering.technique), depth);
    for (std::size_t pixel = 0; pixel < seen.eye.size(); pixel += 4) {
      EXPECT_NEAR(seen.eye[pixel] / expected, 1.0, error) << depth;
      EXPECT_NEAR(seen.eye[pixel + 3], std::exp(-depth), error * std::min(depth, 1.0)) << depth;
    }
  }
}

TEST_F(SingleScattering, TransmittedLightOfASlab) {
  // With the sun above and the eye below, both vertical, the result is d exp(-d).
  for (const double depth : {0.01, 0.5, 3.0}) {
    const Seen seen = Look(depth, -89.9, 89.9);
    const double expected = PhaseTerm(-89.9, 89.9) * depth * std::exp(-depth);
    // The tilt of 0.1 degree makes the sliced extent 0.7 % larger than the slab. d exp(-d) changes
    // by (1 - d) times that.
    const double error = 0.007 * std::fmax(1.0, std::abs(1.0 - depth));
    EXPECT_NEAR(seen.radiance / expected, 1.0, kTextureError + error) << depth;
  }
}

TEST_F(SingleScattering, ThinSlabsKeepTheirDigits) {
  // With half-float buffers each of the 256 slices rounded 1 - 1e-6 to 1, or attenuated by 5e-4
  // instead.
  scene::SetSlices(&scene_.rendering.technique, 256);
  for (const double depth : {3e-4, 1e-3}) {
    const double expected = PhaseTerm(89.9, 89.9) * depth;
    EXPECT_NEAR(Look(depth, 89.9, 89.9).radiance / expected, 1.0, 0.006 + depth);
  }
}

TEST_F(SingleScattering, AlbedoScalesTheLight) {
  const double white = Look(1.0, 80.0, 60.0).radiance;
  for (scene::FieldParameters& field : scene_.fields) field.optics.albedo = 0.5F;
  EXPECT_NEAR(Look(1.0, 80.0, 60.0).radiance / white, 0.5, kTextureError);
}

TEST_F(HalfAngle, ThinSlabsKeepTheirDigitsInLightFromAllAround) {
  even_light_ = true;
  test_support::SetMode(&scene_.rendering.technique, test_support::kUniformPhase);
  scene::SetSlices(&scene_.rendering.technique, 1024);
  SetPhase(physics::PhaseKind::kRayleigh, 0.0F);
  // In single precision the opacity of a slice with an optical depth of 3e-7 has an error of a
  // fifth.
  for (const double depth : {3e-4, 1e-3}) {
    EXPECT_NEAR(Look(depth, 89.9, 89.9).radiance / depth, 1.0, 0.006 + depth) << depth;
  }
}

TEST_F(HalfAngle, WideViewsKeepTheStormWhereRaysMeetSlicesAgainstTheirOrder) {
  // The eye looks straight up from below the slab, and the sun is on the horizon: slices face 45
  // degrees from the axis.
  test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
  scene::SetSlices(&scene_.rendering.technique, 200);
  width_m_ = 10'000.0;
  constexpr double kDepth = 1.0;
  scene::View view;
  view.eye_m = {0.0, 0.0, -500.0};
  view.forward = {0.0, 0.0, 1.0};
  view.right = {1.0, 0.0, 0.0};
  view.up = {0.0, -1.0, 0.0};
  view.tan_half_width = view.tan_half_height = 2.0;
  for (const double sun_elevation_deg : {1.0, -1.0}) {
    const Seen seen = Look(kDepth, view, sun_elevation_deg);
    const glm::dvec3 sun = scene::Direction(kSunAzimuth_deg, sun_elevation_deg);
    const Slicing slicing = SliceBox({glm::dvec3(width_m_, width_m_, kHeight_m) / 2.0}, sun,
                                     -view.forward, *scene::SlicesOf(scene_.rendering.technique));
    ASSERT_EQ(OrderOf(slicing, view), SliceOrder::kBoth);
    int along = 0;
    int against = 0;
    for (int i = 0; i < 81; ++i) {
      const int column = i % 9;
      const int row = i / 9;
      const double x = ((column + 0.5) / 9 * 2 - 1) * view.tan_half_width;
      const double y = ((row + 0.5) / 9 * 2 - 1) * view.tan_half_height;
      const glm::dvec3 ray = glm::normalize(view.forward + x * view.right + y * view.up);
      const double climb = glm::dot(ray, slicing.normal);
      if (std::abs(climb) < 0.1) continue;
      ++(climb < 0.0 ? along : against);
      // The number of slices on a path is the number of planes it crosses, or one less.
      const double path = slicing.spacing_m / std::abs(climb) / kHeight_m * kDepth;
      const double depth = -std::log(seen.eye[4 * i + 3]);
      EXPECT_NEAR(depth, kDepth / ray.z, path + 0.005) << i << ", sun " << sun_elevation_deg;
    }
    EXPECT_GT(std::min(along, against), 5);
  }
}

TEST_F(HalfAngle, LightSpreadsFromClearAirIntoTheCloudsEdge) {
  // There are two clouds with a gap between them. A texel within a cloud has the light of its ray
  // alone. At the edge it also has a part of its neighbours' light.
  test_support::SetMode(&scene_.rendering.technique, test_support::kUniformPhase);
  scene::MediumSettingsOf(&scene_.rendering.technique)->theta_f_deg = 80.0;
  SetPhase(physics::PhaseKind::kHenyeyGreenstein, 0.6F);
  with_gap_ = true;
  struct Shares {
    double within = 0.0;  // fraction of the light that is left farthest from the gap
    double edge = 0.0;    // sum of the excess, in columns of texels with that light
  };
  const auto shares = [&](double depth) {
    const Seen seen = Look(depth, 89.9, 89.9);
    const auto texels = static_cast<std::size_t>(std::lround(std::sqrt(seen.light.size() / 4)));
    std::vector<double> light;
    for (std::size_t i = 0; i < texels * texels; ++i) light.push_back(seen.light[4 * i]);
    Shares found{*std::min_element(light.begin(), light.end())};
    EXPECT_NEAR(*std::max_element(light.begin(), light.end()), 1.0, 1e-6) << "in the gap";
    for (const double share : light) {
      if (share < 0.5 * (found.within + 1.0)) found.edge += (share / found.within - 1.0) / texels;
    }
    return found;
  };
  for (const int slices : {64, 256}) {
    scene::SetSlices(&scene_.rendering.technique, slices);
    for (scene::FieldParameters& field : scene_.fields) field.optics.albedo = 1.0F;
    const Shares scattered = shares(4.0);
    // Without scattered light, the edge is the one cell over which extinction rises.
    for (scene::FieldParameters& field : scene_.fields) field.optics.albedo = 0.0F;
    const Shares straight = shares(-std::log(scattered.within));
    // The sun is a tenth of a degree off the vertical, so its rays may meet one slice more or
    // fewer.
    EXPECT_NEAR(std::log(straight.within / scattered.within), 0.0, 4.0 / slices);
    EXPECT_GT(scattered.edge / straight.edge, 1.25) << slices;
    EXPECT_LT(scattered.edge / straight.edge, 1.75) << slices;
  }
}

TEST_F(HalfAngle, PaperTransportIsAsPrinted) {
  // If light is uniform across a slice, the slice multiplies it by T + (1 - T) c, with c =
  // CP(theta_f / 2). CP is the cumulative phase function (the paper's eq. 13). With optical depth
  // 10 and c = 0.9, 16 slices leave 0.467 and 128 leave 0.381 (limit 0.368).
  test_support::SetMode(&scene_.rendering.technique, test_support::kUniformPhase);
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  SetPhase(physics::PhaseKind::kCornetteShanks, 0.979F);
  double angle_deg = 5.0;  // found by bisection, so that CP(angle) = 0.9
  for (double step = 4.0; step > 1e-6; step /= 2) {
    const double within = physics::CumulativePhase(
        physics::PhaseOf(scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].optics),
        angle_deg * std::numbers::pi / 180);
    angle_deg += within < 0.9 ? step : -step;
  }
  scene::MediumSettingsOf(&scene_.rendering.technique)->theta_f_deg = 2.0 * angle_deg;
  for (const auto& [slices, expected] : {std::pair(16, 0.467), std::pair(128, 0.381)}) {
    scene::SetSlices(&scene_.rendering.technique, slices);
    const Seen seen = Look(10.0, 89.9, 89.9);
    // Reads the middle of the light buffer, away from the slab's sides.
    const auto middle = [&] {
      const auto texels = static_cast<std::size_t>(std::lround(std::sqrt(seen.light.size() / 4)));
      return seen.light[4 * (texels / 2 * texels + texels / 2)];
    }();
    EXPECT_NEAR(middle, expected, 0.003) << slices;
  }
}

TEST_F(HalfAngle, ConsistentTransportDoesNotDependOnTheNumberOfSlices) {
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  scene::SetSlices(&scene_.rendering.technique, 16);
  const double coarse = Look(10.0, 60.0, 45.0).radiance;
  scene::SetSlices(&scene_.rendering.technique, 128);
  const double fine = Look(10.0, 60.0, 45.0).radiance;
  // The diffusion term is evaluated once per slice, and here a slice is 0.6 of a mean free path
  // thick. The error is of second order in this thickness.
  EXPECT_NEAR(coarse / fine, 1.0, 0.02);
}

TEST_F(HalfAngle, ThickSlabIsWhite) {
  // Eddington's reflectance of a semi-infinite conservative layer is 1: under a high sun it must
  // come near a white Lambertian's 1 / pi. Milne's exact law is 10-20 % brighter at the zenith than
  // its mean. The single-scattered share, counted in addition to the diffusion term, adds to that.
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  const double radiance = Look(5000.0, 89.0, 89.0).radiance;
  EXPECT_GT(radiance, 0.7 / std::numbers::pi);
  EXPECT_LT(radiance, 1.3 / std::numbers::pi);
}

class OpticalDepths : public HalfAngle, public testing::WithParamInterface<double> {};

TEST_P(OpticalDepths, NothingBreaks) {
  // 40 slices are drawn in several groups (slabs).
  for (const int slices : {8, 40}) {
    for (const auto mode : {test_support::kLowAlbedo, test_support::kPerFieldPhase}) {
      for (const auto transport : {scene::Transport::kPaper, scene::Transport::kConsistent}) {
        for (const double elevation_deg : {-80.0, 30.0, 89.0}) {
          test_support::SetMode(&scene_.rendering.technique, mode);
          test_support::SetTransport(&scene_.rendering.technique, transport);
          scene::SetSlices(&scene_.rendering.technique, slices);
          const Seen seen = Look(GetParam() * slices, elevation_deg, 40.0);
          // In single precision, 1 minus a depth below 1e-7 rounds to 1, but its light does not
          // round to 0.
          EXPECT_TRUE(seen.transmittance < 1.0 || GetParam() < 1e-7);
          // No light reaches the first of several thick slices on a ray.
          if (GetParam() < 10.0 && elevation_deg > 0.0) {
            EXPECT_GT(seen.radiance, 0.0) << elevation_deg;
          }
          for (std::size_t i = 0; i < seen.eye.size(); ++i) {
            ASSERT_TRUE(std::isfinite(seen.eye[i]));
            ASSERT_GE(seen.eye[i], 0.0F);
          }
          EXPECT_LE(seen.transmittance, 1.0);
          for (std::size_t i = 0; i < seen.light.size(); i += 4) {
            ASSERT_GE(seen.light[i], 0.0F);
            ASSERT_LE(seen.light[i], 1.0F) << "a slice may not add light";
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PerSlice, OpticalDepths, testing::Values(1e-8, 1e-4, 1.0, 1e4, 1e8));

}  // namespace
}  // namespace thunderhead::renderers
