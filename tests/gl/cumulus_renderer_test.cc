#include "renderers/cumulus/cumulus_renderer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "clouds/cauliflower.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/geometric.hpp"
#include "glm/matrix.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

constexpr double kRadius_m = 100.0;
constexpr int kSide_px = 96;
// Buffers are half floats with 11 significant bits.
constexpr double kHalfFloat = 1.0 / 1024.0;

class CumulusRendererTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<CumulusRenderer>(std::make_shared<gl::ProgramCache>());
    noises_ = std::make_unique<DetailNoises>();
    settings_.technique = scene::Cumulus{};
    test_support::CumulusOf(settings_.technique).roughness = 0.0F;
    test_support::CumulusOf(settings_.technique).transmission = 0.0F;
    test_support::CumulusOf(settings_.technique).corona = 0.1F;
    settings_.eye_size = glm::ivec2(kSide_px);
    settings_.illumination.towards_sun = scene::Direction(230.0, 40.0);
    settings_.illumination.sunlight = glm::vec3(1.0F, 0.9F, 0.8F);
    LookParallel(130.0);
  }
  void TearDown() override {
    renderer_.reset();
    noises_.reset();
    context_.reset();
  }

  // Looks from the south, without perspective, `half_m` to each side.
  void LookParallel(double half_m) {
    settings_.view = {};
    settings_.view.eye_m = {0.0, -1000.0, 0.0};
    settings_.view.tan_half_width = settings_.view.tan_half_height = 0.0;
    settings_.view.half_width_m = settings_.view.half_height_m = half_m;
  }
  void LookFrom(const glm::dvec3& eye_m, double tan_half) {
    settings_.view = {};
    settings_.view.eye_m = eye_m;
    settings_.view.tan_half_width = settings_.view.tan_half_height = tan_half;
  }

  static clouds::CumulusSurface OneBall() {
    clouds::CumulusSurface surface;
    surface.bubbles = {clouds::BallOf(glm::dvec3(0.0), kRadius_m)};
    surface.finest_m = kRadius_m;
    return surface;
  }
  static clouds::CumulusSurface SmallCauliflower() {
    auto surface = clouds::Cauliflower({7, 3});
    clouds::FitInto({glm::dvec3(-100.0), glm::dvec3(100.0)}, &*surface);
    return *surface;
  }

  scene::Cumulus& Cumulus() { return test_support::CumulusOf(settings_.technique); }

  // Returns the texels of the eye buffer: rgb is the radiance sent, alpha the share of the
  // background that passes.
  std::vector<glm::vec4> Draw(const clouds::CumulusSurface& surface,
                              const std::vector<glm::vec3>& light_map) {
    renderer_->SetSurface(surface);
    EXPECT_TRUE(renderer_->CastShadow(settings_).ok());
    const absl::Status drawn = renderer_->DrawView(settings_, light_map, noises_.get());
    EXPECT_TRUE(drawn.ok()) << drawn;
    std::vector<glm::vec4> texels(static_cast<std::size_t>(kSide_px * kSide_px));
    glGetTextureImage(renderer_->Eye().Get(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    return texels;
  }
  std::vector<glm::vec4> Draw(const clouds::CumulusSurface& surface) {
    return Draw(surface, std::vector<glm::vec3>(9, glm::vec3(0.0F)));
  }

  // The ray through a texel.
  struct Ray {
    glm::dvec3 origin_m;
    glm::dvec3 direction;
  };
  Ray RayOf(int x, int y) const {
    const scene::View& view = settings_.view;
    const double right = 2.0 * (x + 0.5) / kSide_px - 1.0;
    const double up = 2.0 * (y + 0.5) / kSide_px - 1.0;
    return {view.eye_m + right * view.half_width_m * view.right + up * view.half_height_m * view.up,
            glm::normalize(view.forward + right * view.tan_half_width * view.right +
                           up * view.tan_half_height * view.up)};
  }

  struct Hit {
    bool is = false;
    glm::dvec3 normal{0.0};
    double depth_m = 0.0;  // below a ball's surface, at the deepest point of the ray
  };
  Hit MeetBall(const Ray& ray) const {
    const double along_m = -glm::dot(ray.origin_m, ray.direction);
    const glm::dvec3 nearest_m = ray.origin_m + along_m * ray.direction;
    const double inside = kRadius_m * kRadius_m - glm::dot(nearest_m, nearest_m);
    if (inside <= 0.0) return {};
    const glm::dvec3 at_m = nearest_m - std::sqrt(inside) * ray.direction;
    return {true, at_m / kRadius_m, kRadius_m - glm::length(nearest_m)};
  }

  void ExpectLambert(const std::vector<glm::vec4>& texels, double least_cosine) {
    int compared = 0;
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        const Hit hit = MeetBall(RayOf(x, y));
        if (!hit.is || hit.depth_m < 0.11 * kRadius_m) continue;
        const double cosine = glm::dot(hit.normal, settings_.illumination.towards_sun);
        if (cosine > 0.0 && cosine < least_cosine) continue;
        const glm::dvec3 expected = glm::dvec3(settings_.illumination.sunlight) *
                                    (std::max(cosine, 0.0) * std::numbers::inv_pi);
        const glm::dvec4 got(texels[static_cast<std::size_t>(y * kSide_px + x)]);
        for (int i = 0; i < 3; ++i) {
          ASSERT_NEAR(got[i], expected[i], kHalfFloat * (expected[i] + 1e-3) + 2e-4)
              << x << ' ' << y;
        }
        ASSERT_EQ(got.a, 0.0);
        ++compared;
      }
    }
    EXPECT_GT(compared, kSide_px * kSide_px / 8);
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<CumulusRenderer> renderer_;
  std::unique_ptr<DetailNoises> noises_;
  RenderSettings settings_;
};

TEST_F(CumulusRendererTest, ABallsCoreIsLamberts) {
  Cumulus().component = scene::CumulusComponent::kDirect;
  // At the terminator the finite texels of the shadow map let the ball shade itself.
  ExpectLambert(Draw(OneBall()), 0.15);
  LookFrom({0.0, -400.0, 0.0}, 0.35);
  ExpectLambert(Draw(OneBall()), 0.15);
  LookFrom({0.0, -5e5, 0.0}, 2.6e-4);
  ExpectLambert(Draw(OneBall()), 0.15);
}

TEST_F(CumulusRendererTest, BareEllipsoidsAreLambertsUpToTheirEdge) {
  Cumulus().component = scene::CumulusComponent::kBalls;
  ExpectLambert(Draw(OneBall()), 0.0);
}

TEST_F(CumulusRendererTest, TheCoronasDensityRisesLinearlyWithDepth) {
  const std::vector<glm::vec4> texels = Draw(OneBall());
  int in_corona = 0;
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const Hit hit = MeetBall(RayOf(x, y));
      const double rho = hit.is ? std::clamp(hit.depth_m / (0.1 * kRadius_m), 0.0, 1.0) : 0.0;
      const double passes = texels[static_cast<std::size_t>(y * kSide_px + x)].a;
      ASSERT_NEAR(passes, 1.0 - rho, 2e-3) << x << ' ' << y;
      in_corona += rho > 0.0 && rho < 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(in_corona, 200);
}

TEST_F(CumulusRendererTest, TheCoronaShinesAtSilhouettesAgainstTheSunOnly) {
  Cumulus().component = scene::CumulusComponent::kCorona;
  const auto ring = [&](const std::vector<glm::vec4>& texels) {
    double most = 0.0;
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        const Hit hit = MeetBall(RayOf(x, y));
        const glm::vec4& texel = texels[static_cast<std::size_t>(y * kSide_px + x)];
        const bool in_corona = hit.is && hit.depth_m < 0.1 * kRadius_m;
        if (!in_corona) {
          EXPECT_EQ(glm::vec3(texel), glm::vec3(0.0F)) << x << ' ' << y;
        }
        most = std::max(most, static_cast<double>(texel.r));
      }
    }
    return most;
  };
  settings_.illumination.towards_sun = scene::Direction(0.0, 5.0);  // behind the ball
  EXPECT_GT(ring(Draw(OneBall())), 0.3);
  settings_.illumination.towards_sun = scene::Direction(180.0, 5.0);  // behind the eye
  EXPECT_EQ(ring(Draw(OneBall())), 0.0);
}

// Over all sun directions the corona sends no more than the share of sunlight that it takes, rho.
TEST_F(CumulusRendererTest, TheCoronaSendsNoMoreThanItTakes) {
  Cumulus().component = scene::CumulusComponent::kCorona;
  settings_.illumination.sunlight = glm::vec3(1.0F);
  std::vector<glm::vec3> sums(static_cast<std::size_t>(kSide_px * kSide_px), glm::vec3(0.0F));
  constexpr int kSines = 20;
  constexpr int kAzimuths = 8;
  for (int i = 0; i < kSines; ++i) {
    // Integrates about the axis of view, in finer steps near the lobe.
    const double share = (i + 0.5) / kSines;
    const double angle = share * share * std::numbers::pi / 2.0;
    const double solid = 2.0 * share / kSines * std::numbers::pi / 2.0 * std::sin(angle) * 2.0 *
                         std::numbers::pi / kAzimuths;
    for (int j = 0; j < kAzimuths; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * j / kAzimuths;
      settings_.illumination.towards_sun = {std::sin(angle) * std::cos(azimuth), std::cos(angle),
                                            std::sin(angle) * std::sin(azimuth)};
      const std::vector<glm::vec4> texels = Draw(OneBall());
      for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] += static_cast<float>(solid) * glm::vec3(texels[k]);
      }
    }
  }
  double most = 0.0;
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const Hit hit = MeetBall(RayOf(x, y));
      const double rho = hit.is ? std::clamp(hit.depth_m / (0.1 * kRadius_m), 0.0, 1.0) : 0.0;
      const double sent = sums[static_cast<std::size_t>(y * kSide_px + x)].r;
      ASSERT_LE(sent, 1.03 * rho * (1.0 - rho) + 1e-3) << x << ' ' << y;
      most = std::max(most, sent);
    }
  }
  EXPECT_GT(most, 0.15);  // rho (1 - rho) is at most 1/4
}

TEST_F(CumulusRendererTest, ComponentsSumToTheWhole) {
  Cumulus().roughness = 0.6F;
  Cumulus().transmission = 0.1F;
  settings_.illumination.towards_sun = scene::Direction(330.0, 25.0);
  std::vector<glm::vec3> light_map(9, glm::vec3(0.01F));
  light_map[0] = glm::vec3(0.1F, 0.2F, 0.3F);
  const clouds::CumulusSurface surface = SmallCauliflower();
  const std::vector<glm::vec4> whole = Draw(surface, light_map);
  std::vector<glm::vec3> sum(whole.size(), glm::vec3(0.0F));
  for (const auto component :
       {scene::CumulusComponent::kDirect, scene::CumulusComponent::kInterReflection,
        scene::CumulusComponent::kAmbient, scene::CumulusComponent::kCorona}) {
    Cumulus().component = component;
    const std::vector<glm::vec4> part = Draw(surface, light_map);
    float brightest = 0.0F;
    for (std::size_t i = 0; i < part.size(); ++i) {
      sum[i] += glm::vec3(part[i]);
      brightest = std::max(brightest, part[i].g);
      ASSERT_EQ(part[i].a, whole[i].a);
    }
    EXPECT_GT(brightest, 0.01F) << static_cast<int>(component);
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      // Each of up to ten layers is rounded in each of the pictures.
      ASSERT_NEAR(sum[i][k], whole[i][k], 10.0 * kHalfFloat * (whole[i][k] + 0.01)) << i;
    }
  }
}

// A white furnace: a cloud that absorbs nothing and is lit evenly from all directions is invisible.
TEST_F(CumulusRendererTest, AWhiteFurnaceHidesTheCloud) {
  settings_.illumination.sunlight = glm::vec3(0.0F);
  Cumulus().roughness = 0.6F;
  Cumulus().trap = 0.9F;
  std::vector<glm::vec3> light_map(9, glm::vec3(0.0F));
  light_map[0] = glm::vec3(1.0F);
  int hidden = 0;
  for (const glm::vec4& texel : Draw(SmallCauliflower(), light_map)) {
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(texel[k] + texel.a, 1.0, 0.01);
    hidden += texel.a < 0.01F ? 1 : 0;
  }
  EXPECT_GT(hidden, kSide_px * kSide_px / 8) << "there is a cloud";
}

TEST_F(CumulusRendererTest, NothingIsBrighterThanItsTrapsAllow) {
  Cumulus().roughness = 1.0F;
  Cumulus().transmission = 0.2F;
  Cumulus().trap = 0.6F;
  std::vector<glm::vec3> light_map(9, glm::vec3(0.0F));
  light_map[0] = glm::vec3(0.3F);
  const clouds::CumulusSurface surface = SmallCauliflower();
  for (const double azimuth_deg : {180.0, 270.0, 355.0}) {
    for (const double elevation_deg : {90.0, 30.0, 0.0}) {
      settings_.illumination.towards_sun = scene::Direction(azimuth_deg, elevation_deg);
      float brightest = 0.0F;
      for (const glm::vec4& texel : Draw(surface, light_map)) {
        ASSERT_TRUE(std::isfinite(texel.r + texel.g + texel.b + texel.a));
        ASSERT_GE(std::min({texel.r, texel.g, texel.b}), 0.0F);
        ASSERT_GE(texel.a, 0.0F);
        ASSERT_LE(texel.a, 1.0F);
        // The bound of the core is the sum of Lambert's law (1), the traps of all scales (1 / 0.4),
        // the transmitted light (0.2) and the surroundings (0.3). The bound of the corona in front
        // of it is that of the narrowest lobe.
        const double core = std::numbers::inv_pi * (1.0 + 1.0 / 0.4 + 0.2) + 0.3;
        const double corona = 0.25 * 401.0 * 0.5 * std::numbers::inv_pi;
        ASSERT_LE(texel.r, core + corona);
        brightest = std::max(brightest, texel.r);
      }
      // The pixel is brighter than the surroundings alone, so the sun reaches it.
      EXPECT_GT(brightest, 0.35F) << azimuth_deg << ' ' << elevation_deg;
    }
  }
}

TEST_F(CumulusRendererTest, ValleysAreBrighterThanWithoutTraps) {
  Cumulus().component = scene::CumulusComponent::kInterReflection;
  settings_.illumination.towards_sun = scene::Direction(180.0, 30.0);
  const auto sum_of = [](const std::vector<glm::vec4>& texels) {
    double sum = 0.0;
    for (const glm::vec4& texel : texels) sum += texel.g;
    return sum;
  };
  // Two scales trap more light than one.
  clouds::CumulusSurface two = SmallCauliflower();
  clouds::CumulusSurface one = two;
  for (clouds::Bubble& bubble : one.bubbles) bubble.parent = -1;
  const double with_two = sum_of(Draw(two));
  const double with_one = sum_of(Draw(one));
  EXPECT_GT(with_one, 0.0);
  EXPECT_GT(with_two, 1.1 * with_one);
  Cumulus().trap = 0.0F;
  EXPECT_EQ(sum_of(Draw(two)), 0.0);
}

// The axes are 100 : 1, seen from the side that looks thin and from the other side. Pixels are as
// flat as the ellipsoid: as many lie across it vertically as horizontally.
TEST_F(CumulusRendererTest, AFlatEllipsoidKeepsItsShape) {
  for (const bool upright : {false, true}) {
    clouds::Ellipsoid ellipsoid;
    ellipsoid.radii_m = upright ? glm::dvec3(100.0, 1.0, 100.0) : glm::dvec3(100.0, 100.0, 1.0);
    clouds::CumulusSurface surface;
    surface.bubbles = {clouds::BubbleOf(ellipsoid)};
    surface.finest_m = 1.0;
    Cumulus().component = scene::CumulusComponent::kBalls;
    settings_.illumination.towards_sun = scene::Direction(180.0, 0.0);
    const double half_height_m = upright ? 100.0 : 1.0;
    settings_.view.half_height_m = 1.3 * half_height_m;
    double covered = 0.0;
    for (const glm::vec4& texel : Draw(surface)) {
      ASSERT_TRUE(std::isfinite(texel.r));
      covered += 1.0 - texel.a;
    }
    const double texel_m2 = 260.0 / kSide_px * (2.6 * half_height_m / kSide_px);
    const double area_m2 = std::numbers::pi * 100.0 * half_height_m;
    EXPECT_NEAR(covered * texel_m2 / area_m2, 1.0, 0.02) << upright;
  }
}

TEST_F(CumulusRendererTest, FromInsideABallItIsWhite) {
  Cumulus().transmission = 0.5F;
  LookFrom({0.0, 0.0, 0.0}, 1.0);
  for (const glm::vec4& texel : Draw(OneBall())) {
    ASSERT_EQ(texel.a, 0.0F);
    ASSERT_TRUE(std::isfinite(texel.r));
    ASSERT_GT(texel.r, 0.1F);
  }
}

TEST_F(CumulusRendererTest, ABaseCutsFlat) {
  clouds::CumulusSurface surface = OneBall();
  surface.base_m = 0.0;
  Cumulus().component = scene::CumulusComponent::kBalls;
  const std::vector<glm::vec4> texels = Draw(surface);
  EXPECT_EQ(renderer_->HalfExtent_m().z, 50.0);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const Ray ray = RayOf(x, y);
      const bool covered = texels[static_cast<std::size_t>(y * kSide_px + x)].a < 0.5F;
      if (ray.origin_m.z < -3.0) {
        EXPECT_FALSE(covered);
      }
      if (ray.origin_m.z > 3.0 && std::hypot(ray.origin_m.x, ray.origin_m.z) < 97.0) {
        EXPECT_TRUE(covered);
      }
    }
  }
}

// The valley between two adjacent balls has no edge: where they meet, their shading is mixed.
TEST_F(CumulusRendererTest, BallsThatMeetAreMixed) {
  clouds::CumulusSurface surface;
  surface.bubbles = {clouds::BallOf({-50.0, 0.0, 0.0}, 80.0),
                     clouds::BallOf({50.0, 0.0, 0.0}, 80.0)};
  surface.finest_m = 80.0;
  Cumulus().component = scene::CumulusComponent::kDirect;
  Cumulus().trap = 0.0F;
  settings_.illumination.towards_sun = scene::Direction(225.0, 0.0);
  const auto steepest = [&](float corona) {
    Cumulus().corona = corona;
    const std::vector<glm::vec4> texels = Draw(surface);
    float most = 0.0F;
    const int row = kSide_px / 2 * kSide_px;
    for (int x = kSide_px / 2 - 6; x < kSide_px / 2 + 6; ++x) {
      const float here = texels[static_cast<std::size_t>(row + x)].r;
      most = std::max(most, std::abs(texels[static_cast<std::size_t>(row + x + 1)].r - here));
    }
    return most;
  };
  EXPECT_LT(steepest(0.3F), 0.5F * steepest(0.01F));
}

}  // namespace
}  // namespace thunderhead::renderers
