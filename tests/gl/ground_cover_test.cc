// Tests of ground cover in pictures: fields, land use with water, coasts and borders, and rings.
// They compare with the formulas on the CPU and with the reference.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "physics/field_pattern.h"
#include "reference/trace_scene.h"
#include "renderers/scene_renderer.h"
#include "scene/ground.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

glm::vec3 Pixel(const std::vector<float>& pixels, std::size_t index) {
  return {pixels[4 * index], pixels[4 * index + 1], pixels[4 * index + 2]};
}

float Luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

// A fixture with a black sky and no haze. The visible light of the ground is the sun's, through air
// that is the same for every cover.
class GroundCoverTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    scene_.output = {96, 64, 90};
    scene_.sky = {0.0, 0.2, 1.0};
    scene_.sun = {270.0, 45.0, 1.0};
    scene_.camera = scene::TopDownCamera{{3000.0, -2000.0}, 12e3};
    scene_.fields[0].visible = false;
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  std::vector<float> Pixels(scene::GroundCover cover, bool rings = false, bool borders = false) {
    scene_.ground = {.cover = cover, .borders = borders, .rings = rings};
    DrawQuality quality;
    quality.single_precision = true;
    const auto frame = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(frame.ok()) << frame.status();
    EXPECT_EQ(frame->content.ground, scene::DrawnGround(scene_, *fields_));
    not_shown_ = frame->content.not_shown;
    return frame::ReadLinear(*frame->radiance);
  }

  std::size_t Count() const {
    return static_cast<std::size_t>(scene_.output.width_px) *
           static_cast<std::size_t>(scene_.output.height_px);
  }

  // Sets land use with sea in the west of 40 km and grassland in the east, under snow in the north.
  void HaveCoast() {
    auto fields = std::make_shared<volume::HydrometeorFields>(*fields_);
    fields->grid.spacing_m = {1000.0, 1000.0, fields->grid.spacing_m.z};
    fields->grid.cells = {40, 40, fields->grid.cells.z};
    fields->grid.low_corner_m = {-20e3, -20e3, fields->grid.low_corner_m.z};
    fields->fields.clear();
    fields->condensate = {};
    fields->terrain_height_m.assign(1600, 0.0F);
    volume::LandColumns columns;
    for (int i = 0; i < 1600; ++i) {
      columns.land_use.push_back(i % 40 < 20 ? 16.0F : 7.0F);
      columns.snow_share.push_back(i / 40 >= 30 ? 1.0F : 0.0F);
    }
    fields->land = volume::MakeLandSurface(columns, {40, 40});
    fields_ = fields;
  }

  // Sets a border line of three points, in texels of 500 m.
  void HaveBorder() {
    auto fields = std::make_shared<volume::HydrometeorFields>(*fields_);
    const volume::BorderGrid grid{{-20e3, -20e3}, 500.0, {80, 80}, 0.0};
    fields->borders = std::make_shared<const volume::BorderMap>(
        volume::MakeBorderMap({{{kBorder_m.begin(), kBorder_m.end()}, 1.0F}}, grid));
    fields_ = fields;
  }

  // Returns the pixel that shows a place on the ground.
  std::size_t PixelOf(const glm::dvec2& place_m) const {
    const scene::View view = scene::ViewOf(scene_, *fields_);
    const glm::dvec2 off_m = place_m - view.touch_m;
    const double height_m = -0.5 * view.ground_curvature_per_m * glm::dot(off_m, off_m);
    const glm::dvec3 from_eye_m = glm::dvec3(place_m, height_m) - view.eye_m;
    const double depth_m = glm::dot(from_eye_m, view.forward);
    const glm::dvec2 device(
        glm::dot(from_eye_m, view.right) / (view.half_width_m + depth_m * view.tan_half_width),
        glm::dot(from_eye_m, view.up) / (view.half_height_m + depth_m * view.tan_half_height));
    const glm::dvec2 size(scene_.output.width_px, scene_.output.height_px);
    const glm::ivec2 pixel(glm::floor((0.5 + 0.5 * device) * size));
    return static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(pixel.x);
  }

  picture::LinearPicture Traced(double samples) {
    reference::RefineLimits limits;
    limits.samples_per_pixel = static_cast<int>(samples);
    const auto traced = reference::TraceScene(scene_, *fields_, 0.0, limits, {}, {});
    EXPECT_TRUE(traced.ok()) << traced.status();
    return traced->image;
  }

  static constexpr std::array kBorder_m = {glm::dvec2(-9e3, -6'130.0), glm::dvec2(1'270.0, 1'130.0),
                                           glm::dvec2(9e3, 2e3)};
  std::vector<scene::NotShown> not_shown_;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
  scene::Scene scene_ = test_support::PlainScene();
};

// The tolerance covers that the device filters a texture of 8 bits, whereas the CPU uses floats.
TEST_F(GroundCoverTest, FieldsAreThePatternOfTheirPixels) {
  const std::vector<float> plain = Pixels(scene::GroundCover::kPlain);
  const std::vector<float> fields = Pixels(scene::GroundCover::kFields);
  const double pixel_m = 12e3 / 96.0;
  double largest = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const glm::vec2 place_m(3000.0 + (x - 47.5) * pixel_m, -2000.0 + (y - 31.5) * pixel_m);
      const glm::vec3 expected = physics::FieldPattern::Plains().Reflectance(
          place_m, glm::vec2(static_cast<float>(pixel_m)), 1.0F);
      const auto at = static_cast<std::size_t>(96 * y + x);
      const glm::vec3 seen = Pixel(fields, at) / Pixel(plain, at);
      for (int color = 0; color < 3; ++color) {
        ASSERT_NEAR(seen[color], expected[color], 0.02F) << place_m.x << ' ' << place_m.y;
      }
      largest = std::max(largest, std::abs(Luminance(seen) - 1.0));
    }
  }
  EXPECT_GT(largest, 0.2);
}

TEST_F(GroundCoverTest, FieldsAreAsBrightAsPlainGroundOnAverage) {
  scene_.camera = scene::TopDownCamera{{0.0, 0.0}, 150e3};
  const std::vector<float> plain = Pixels(scene::GroundCover::kPlain);
  const std::vector<float> fields = Pixels(scene::GroundCover::kFields);
  double of_plain = 0.0;
  double of_fields = 0.0;
  for (std::size_t i = 0; i < Count(); ++i) {
    of_plain += Luminance(Pixel(plain, i));
    of_fields += Luminance(Pixel(fields, i));
  }
  EXPECT_NEAR(of_fields / of_plain, 1.0, 0.015);
}

// Compares with pictures of 64 rays per pixel, from a low eye and from a higher one. The RMS error
// is given as a share of the mean.
TEST_F(GroundCoverTest, OneRayAPixelIsNearMany) {
  for (const double elevation_deg : {6.0, 25.0}) {
    scene_.camera = scene::OrbitCamera{{0.0, 0.0, 0.0}, 200.0, elevation_deg, 30e3, 35.0};
    scene_.output = {60, 40, 90};
    const std::vector<float> one = Pixels(scene::GroundCover::kFields);
    scene_.output = {480, 320, 90};
    const std::vector<float> many = Pixels(scene::GroundCover::kFields);
    double squares = 0.0;
    double mean = 0.0;
    int count = 0;
    // The upper part of the lower view is sky.
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 60; ++x) {
        float sum = 0.0F;
        for (int j = 0; j < 8; ++j) {
          for (int i = 0; i < 8; ++i) {
            sum += Luminance(Pixel(many, static_cast<std::size_t>(480 * (8 * y + j) + 8 * x + i)));
          }
        }
        const float averaged = sum / 64.0F;
        const float seen = Luminance(Pixel(one, static_cast<std::size_t>(60 * y + x)));
        squares += (seen - averaged) * (seen - averaged);
        mean += averaged;
        ++count;
      }
    }
    EXPECT_LT(std::sqrt(squares / count) / (mean / count), 0.06) << elevation_deg;
  }
}

TEST_F(GroundCoverTest, TheStormGetsTheSameLightFromEveryCover) {
  scene_.fields[0].visible = true;
  scene_.sky = {1.0, 0.4, 1.5};
  scene_.camera = scene::OrbitCamera{{0.0, 0.0, 1000.0}, 200.0, 4.0, 6e3, 35.0};
  const std::vector<float> plain = Pixels(scene::GroundCover::kPlain);
  const std::vector<float> fields = Pixels(scene::GroundCover::kFields, true);
  int storm = 0;
  for (std::size_t i = 0; i < Count(); ++i) {
    if (plain[4 * i + 3] < 0.99F) continue;
    ++storm;
    // Up to a hundredth of the ground's light shows through the storm.
    ASSERT_NEAR(Luminance(Pixel(fields, i)), Luminance(Pixel(plain, i)), 1e-3F);
  }
  EXPECT_GT(storm, 500);
}

TEST_F(GroundCoverTest, RingsAreOrangeAndVanishWhenOff) {
  scene_.camera = scene::TopDownCamera{{0.0, 0.0}, 60e3};
  scene_.output = {480, 320, 90};
  const std::vector<float> without = Pixels(scene::GroundCover::kPlain);
  const std::vector<float> with = Pixels(scene::GroundCover::kPlain, true);
  const auto red_at = [&](const std::vector<float>& pixels, double east_m, double north_m) {
    const auto x = static_cast<std::size_t>((east_m / 60e3 + 0.5) * 480);
    const auto y = static_cast<std::size_t>((north_m / 40e3 + 0.5) * 320);
    const glm::vec3 seen = Pixel(pixels, 480 * y + x);
    return seen.x / seen.y;
  };
  for (const glm::dvec2 place_m : {glm::dvec2(10e3, 10.0), glm::dvec2(-20e3, 10.0),
                                   glm::dvec2(10.0, -10e3), glm::dvec2(10.0, 5e3)}) {
    EXPECT_GT(red_at(with, place_m.x, place_m.y), 1.5F * red_at(without, place_m.x, place_m.y));
  }
  EXPECT_EQ(red_at(with, 10.0, -5e3), red_at(without, 10.0, -5e3));
  EXPECT_EQ(red_at(with, 15e3, 10.0), red_at(without, 15e3, 10.0));
  // On a grid that is turned against true north, the arrow points to true north, here to the left.
  auto turned = std::make_shared<volume::HydrometeorFields>(*fields_);
  turned->true_north_deg = -90.0;
  fields_ = turned;
  const std::vector<float> left = Pixels(scene::GroundCover::kPlain, true);
  EXPECT_GT(red_at(left, -15e3, 10.0), 1.5F * red_at(without, -15e3, 10.0));
  EXPECT_EQ(red_at(left, 10.0, 5e3), red_at(without, 10.0, 5e3));
  EXPECT_GT(red_at(left, 10.0, -10e3), 1.5F * red_at(without, 10.0, -10e3));
}

// Views are from above and from the side, near and far, where a pixel is wider than the line. A
// line is painted yellow, so it leaves hardly any blue.
TEST_F(GroundCoverTest, BordersAreWhereTheirPointsAreProjected) {
  HaveBorder();
  scene_.output = {480, 320, 90};
  for (const scene::Camera& camera :
       {scene::Camera(scene::TopDownCamera{{0.0, 0.0}, 30e3}),
        scene::Camera(scene::TopDownCamera{{0.0, 0.0}, 150e3}),
        scene::Camera(scene::OrbitCamera{{0.0, 0.0, 0.0}, 200.0, 25.0, 30e3, 35.0}),
        scene::Camera(scene::OrbitCamera{{0.0, 0.0, 0.0}, 300.0, 50.0, 100e3, 35.0})}) {
    scene_.camera = camera;
    const std::vector<float> without = Pixels(scene::GroundCover::kPlain);
    const std::vector<float> with = Pixels(scene::GroundCover::kPlain, false, true);
    const auto blue_share = [](const glm::vec3& seen) { return seen.z / seen.x; };
    std::vector<bool> near(Count(), false);
    int on_line = 0;
    for (std::size_t i = 1; i < kBorder_m.size(); ++i) {
      // The ends are left out. They lie in the middles of pixels that also show ground beyond them.
      for (int step = 4; step <= 196; ++step) {
        const glm::dvec2 place_m = glm::mix(kBorder_m[i - 1], kBorder_m[i], step / 200.0);
        const std::size_t at = PixelOf(place_m);
        ASSERT_LT(at, Count());
        // The line is at least a pixel and a half wide, and the corner is cut by parts of a texel.
        const double to_corner_m = glm::distance(place_m, kBorder_m[1]);
        if (to_corner_m > 1000.0) {
          EXPECT_LT(blue_share(Pixel(with, at)), 0.75F * blue_share(Pixel(without, at)))
              << camera.index() << ' ' << place_m.x << ' ' << place_m.y;
          ++on_line;
        }
        for (int y = -8; y <= 8; ++y) {
          for (int x = -8; x <= 8; ++x) near[at + static_cast<std::size_t>(480 * y + x)] = true;
        }
      }
    }
    EXPECT_GT(on_line, 200);
    for (std::size_t i = 0; i < Count(); ++i) {
      if (near[i]) continue;
      ASSERT_EQ(Pixel(with, i), Pixel(without, i)) << i;
    }
  }
}

TEST_F(GroundCoverTest, BordersThatCannotBeDrawnAreNotShown) {
  const std::vector<float> without = Pixels(scene::GroundCover::kPlain);
  EXPECT_TRUE(not_shown_.empty());
  EXPECT_EQ(Pixels(scene::GroundCover::kPlain, false, true), without);
  ASSERT_EQ(not_shown_.size(), 1U);
  EXPECT_EQ(not_shown_[0].code, scene::NotShown::Code::kBorders);
  HaveBorder();
  EXPECT_NE(Pixels(scene::GroundCover::kPlain, false, true), without);
  EXPECT_TRUE(not_shown_.empty());
  // There are border data, but no line here.
  auto fields = std::make_shared<volume::HydrometeorFields>(*fields_);
  fields->borders = std::make_shared<const volume::BorderMap>();
  fields_ = fields;
  EXPECT_EQ(Pixels(scene::GroundCover::kPlain, false, true), without);
  EXPECT_TRUE(not_shown_.empty());
}

TEST_F(GroundCoverTest, WaterGlintsBelowTheSunAndLandDoesNot) {
  HaveCoast();
  scene_.sky = {1.0, 0.2, 1.5};
  // Looks from the east over the land's edge to the sun above the sea.
  scene_.sun = {270.0, 30.0, 1.0};
  scene_.camera = scene::OrbitCamera{{-8e3, -8e3, 0.0}, 90.0, 30.0, 6e3, 30.0};
  const std::vector<float> covered = Pixels(scene::GroundCover::kLandUse);
  const std::vector<float> plain = Pixels(scene::GroundCover::kPlain);
  const std::size_t middle = 96 * 32 + 48;
  EXPECT_GT(Luminance(Pixel(covered, middle)), 5.0F * Luminance(Pixel(plain, middle)));
  // Seen from the west, away from the sun, the sea is dark and blue.
  scene_.camera = scene::OrbitCamera{{-8e3, -8e3, 0.0}, 270.0, 60.0, 6e3, 30.0};
  const glm::vec3 away = Pixel(Pixels(scene::GroundCover::kLandUse), middle);
  EXPECT_LT(Luminance(away), 0.5F * Luminance(Pixel(Pixels(scene::GroundCover::kPlain), middle)));
  EXPECT_GT(away.z, 1.3F * away.x);
  // Land has no glint, and snow is white.
  scene_.camera = scene::OrbitCamera{{8e3, -8e3, 0.0}, 90.0, 30.0, 6e3, 30.0};
  const float land = Luminance(Pixel(Pixels(scene::GroundCover::kLandUse), middle));
  EXPECT_LT(land, 1.3F * Luminance(Pixel(plain, middle)));
  scene_.camera = scene::OrbitCamera{{8e3, 16e3, 0.0}, 90.0, 30.0, 6e3, 30.0};
  EXPECT_GT(Luminance(Pixel(Pixels(scene::GroundCover::kLandUse), middle)), 2.0F * land);
}

TEST_F(GroundCoverTest, WithoutLandUseTheGroundIsPlain) {
  const std::vector<float> plain = Pixels(scene::GroundCover::kPlain);
  EXPECT_EQ(Pixels(scene::GroundCover::kLandUse), plain);
}

// Both renderers draw a point where a ray meets the ground. The reference does not filter by a
// pixel's footprint, so pixels are compared in blocks.
TEST_F(GroundCoverTest, TheReferenceShowsTheSameGround) {
  HaveCoast();
  HaveBorder();
  scene_.sky = {1.0, 0.2, 1.5};
  scene_.output = {48, 32, 90};
  for (const auto& [cover, camera] :
       {std::pair{scene::GroundCover::kFields,
                  scene::OrbitCamera{{0.0, 0.0, 0.0}, 200.0, 20.0, 8e3, 35.0}},
        // One view is half sea, half land; another has the sun's glint.
        std::pair{scene::GroundCover::kLandUse,
                  scene::OrbitCamera{{0.0, -8e3, 0.0}, 180.0, 25.0, 10e3, 35.0}},
        std::pair{scene::GroundCover::kLandUse,
                  scene::OrbitCamera{{-8e3, -8e3, 0.0}, 90.0, 40.0, 10e3, 35.0}}}) {
    scene_.camera = camera;
    const std::vector<float> drawn = Pixels(cover, true, true);
    const picture::LinearPicture traced = Traced(96.0);
    double squares = 0.0;
    double mean = 0.0;
    for (int block = 0; block < 6 * 4; ++block) {
      double of_drawn = 0.0;
      double of_traced = 0.0;
      for (int j = 0; j < 8; ++j) {
        for (int i = 0; i < 8; ++i) {
          const auto at =
              static_cast<std::size_t>(48 * (8 * (block / 6) + j) + 8 * (block % 6) + i);
          of_drawn += Luminance(Pixel(drawn, at)) / 64.0;
          // Rows of the traced picture run from top to bottom.
          const auto row = static_cast<std::size_t>(31 - 8 * (block / 6) - j);
          of_traced += Luminance(traced.radiance[48 * row + at % 48]) / 64.0;
        }
      }
      squares += (of_drawn - of_traced) * (of_drawn - of_traced) / 24.0;
      mean += of_traced / 24.0;
    }
    // Bruneton's mean reflectance of rough water is a fit; the other covers agree within a percent.
    const double bound = cover == scene::GroundCover::kFields ? 0.01 : 0.05;
    EXPECT_LT(std::sqrt(squares) / mean, bound) << static_cast<int>(cover);
  }
}

}  // namespace
}  // namespace thunderhead::renderers
