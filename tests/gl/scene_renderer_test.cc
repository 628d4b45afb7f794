#include "renderers/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "scene/view.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SceneRendererTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<SceneRenderer>();
    scene_.output = {48, 32, 90};
    scene::SetSlices(&scene_.rendering.technique, 16);
    Orbit().target_m = {0.0, 0.0, 1000.0};
    Orbit().distance_m = 12e3;
  }
  void TearDown() override {
    renderer_.reset();
    context_.reset();
  }

  scene::OrbitCamera& Orbit() { return std::get<scene::OrbitCamera>(scene_.camera); }

  std::vector<std::string> StagesOf(const DrawQuality& quality = {}) {
    const auto frame = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(frame.ok()) << frame.status();
    std::vector<std::string> names;
    for (const scene::StageTime& stage : frame->stages)
      names.push_back(std::string(scene::NameOf(stage.stage)));
    return names;
  }

  std::vector<float> Pixels(SceneRenderer* renderer) {
    const auto frame = renderer->Draw(scene_, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame::ReadLinear(*frame->radiance);
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<SceneRenderer> renderer_;
  std::shared_ptr<const volume::HydrometeorFields> fields_ =
      support::MakeSlab(4000.0, 2000.0, 0.01);
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(SceneRendererTest, AChangeRerunsOnlyWhatItDirties) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kHalfAngle);
  EXPECT_THAT(StagesOf(),
              ElementsAre("extinction", "upload", "ground", "slices", "air", "composite"));
  EXPECT_THAT(StagesOf(), IsEmpty());
  scene_.display.exposure_ev = 1.0;
  EXPECT_THAT(StagesOf(), IsEmpty());
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("slices", "air", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("ground", "slices", "air", "composite"));
  scene_.fields[0].scale = 2.0F;
  EXPECT_THAT(StagesOf(),
              ElementsAre("extinction", "upload", "ground", "slices", "air", "composite"));
  EXPECT_THAT(StagesOf({0.5, 1.0}), ElementsAre("slices", "air", "composite"));
  fields_ = support::MakeSlab(4000.0, 2000.0, 0.02);
  EXPECT_THAT(StagesOf(),
              ElementsAre("extinction", "upload", "ground", "slices", "air", "composite"));
}

TEST_F(SceneRendererTest, TheLightVolumeIsKeptWhileOnlyTheCameraMoves) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "light", "view", "air", "composite"));
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("view", "air", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "air", "composite"));
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kHalfAngle);
  EXPECT_THAT(StagesOf(), ElementsAre("ground", "slices", "air", "composite"));
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "air", "composite"));
}

TEST_F(SceneRendererTest, WaterPathsThatWereKeptQuicklyAreKeptInFullAtRest) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  DrawQuality moving;
  moving.quick_water_paths = true;
  // Without detail there are no water paths to keep, so the frame at rest needs no new extinction.
  StagesOf(moving);
  EXPECT_THAT(StagesOf(), ElementsAre("view", "air", "composite"));
  scene::MediumSettingsOf(&scene_.rendering.technique)->look.detail = true;
  StagesOf(moving);
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(moving), ElementsAre("view", "air", "composite"));
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "light", "view", "air", "composite"));
  SceneRenderer fresh;
  EXPECT_EQ(Pixels(renderer_.get()), Pixels(&fresh));
  // A result of higher quality is kept.
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(moving), ElementsAre("view", "air", "composite"));
}

TEST_F(SceneRendererTest, ACumulusRerunsOnlyWhatAChangeDirties) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  scene::Cumulus& cumulus = test_support::CumulusOf(scene_.rendering.technique);
  EXPECT_THAT(StagesOf(), ElementsAre("surface", "light", "view", "air", "composite"));
  EXPECT_THAT(StagesOf(), IsEmpty());
  Orbit().azimuth_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("view", "air", "composite"));
  cumulus.component = scene::CumulusComponent::kAmbient;
  EXPECT_THAT(StagesOf(), ElementsAre("view", "air", "composite"));
  cumulus.corona = 0.5F;  // only deeper parts cast a shadow
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "air", "composite"));
  scene_.sun.elevation_deg += 5.0;
  EXPECT_THAT(StagesOf(), ElementsAre("light", "view", "air", "composite"));
  scene::SetSlices(&scene_.rendering.technique, 17);  // the technique has no slices
  EXPECT_THAT(StagesOf(), IsEmpty());
  cumulus.seed = 2;
  EXPECT_THAT(StagesOf(), ElementsAre("surface", "light", "view", "air", "composite"));
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  EXPECT_THAT(StagesOf(), ElementsAre("extinction", "upload", "light", "view", "air", "composite"));
  cumulus.seed = 3;  // this technique does not use it
  EXPECT_THAT(StagesOf(), IsEmpty());
}

TEST_F(SceneRendererTest, ACumulusOfAStormStandsWhereTheStormIs) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  scene_.camera = scene::TopDownCamera{{4000.0, 0.0}, 16e3};
  scene_.sun.elevation_deg = 90.0;  // the shadow lies below the cloud
  const std::vector<float> with = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  for (std::size_t y = 0; y < 32; ++y) {
    for (std::size_t x = 0; x < 48; ++x) {
      const double east_m = 4000.0 + 16e3 * ((static_cast<double>(x) + 0.5) / 48 - 0.5);
      const double north_m = 16e3 * (32.0 / 48.0) * ((static_cast<double>(y) + 0.5) / 32 - 0.5);
      const double outside_m = std::max(std::abs(east_m), std::abs(north_m)) - 2000.0;
      const std::size_t at = 4 * (48 * y + x);
      // Bubbles extend beyond the box, and corners are rounded.
      if (outside_m > 1000.0) {
        ASSERT_NEAR(with[at], without[at], 0.01F * without[at]) << east_m << ' ' << north_m;
      } else if (std::hypot(east_m, north_m) < 1600.0) {
        ASSERT_GT(with[at], 1.5F * without[at]) << east_m << ' ' << north_m;
      }
    }
  }
}

TEST_F(SceneRendererTest, ACumulusWithoutSurfaceIsTheSkyAlone) {
  scene_.fields[0].visible = false;
  const std::vector<float> sky = Pixels(renderer_.get());
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  EXPECT_EQ(Pixels(renderer_.get()), sky);
  scene_.fields[0].visible = true;
  test_support::CumulusOf(scene_.rendering.technique).least_extinction_per_m = 1.0F;
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->content.ellipsoids, 0);
  EXPECT_EQ(frame::ReadLinear(*frame->radiance), sky);
}

// The aureole belongs to the medium. Around balls and surfaces it would follow the cells of a
// medium that is not visible.
TEST_F(SceneRendererTest, OnlyAMediumThatIsSeenHasAnAureole) {
  fields_ = support::MakeSlab(4000.0, 2000.0, 1e-4);
  Orbit().azimuth_deg = 75.0;
  Orbit().elevation_deg = 2.0;
  Orbit().distance_m = 8e3;
  scene_.output = {64, 64, 90};
  scene_.sun = {255.0, 4.0};
  const auto glow_px = [&] {
    const auto seen = frame::ReadLinear(*renderer_->Draw(scene_, fields_, {})->radiance);
    const auto unseen =
        frame::ReadLinear(*renderer_->Draw(scene_, fields_, {.sun_seen = false})->radiance);
    int changed = 0;
    for (std::size_t i = 0; i < seen.size(); i += 4) changed += seen[i] > unseen[i] * 1.01F ? 1 : 0;
    return changed;
  };
  EXPECT_GT(glow_px(), 200);
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kHalfAngle);
  EXPECT_GT(glow_px(), 200);
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kMetaball);
  test_support::MetaballsOf(scene_.rendering.technique).count = 30;
  EXPECT_LE(glow_px(), 9) << "the disc";
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  EXPECT_LE(glow_px(), 9) << "the disc";
}

TEST_F(SceneRendererTest, ACumulusIsDarkAtNight) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  test_support::CumulusOf(scene_.rendering.technique).source = scene::CumulusSource::kCauliflower;
  scene_.sun.elevation_deg = -1.0;
  const std::vector<float> dusk = Pixels(renderer_.get());
  scene_.sun.elevation_deg = -40.0;
  const std::vector<float> night = Pixels(renderer_.get());
  for (std::size_t i = 0; i < night.size(); ++i) {
    ASSERT_TRUE(std::isfinite(dusk[i]));
    ASSERT_GE(dusk[i], 0.0F);
    if (i % 4 == 3) continue;
    ASSERT_LE(night[i], 1e-4F);
  }
  EXPECT_GT(dusk[4 * (16 * 48 + 24)], 1e-3F) << "at dusk the cloud is lit";
}

TEST_F(SceneRendererTest, ACumulusSaysWhatItCannotShow) {
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kCumulus);
  auto rainy = std::make_shared<volume::HydrometeorFields>(*fields_);
  rainy->fields.push_back(rainy->fields.front());
  rainy->fields.back().hydrometeor = physics::Hydrometeor::kRain;
  const auto frame = renderer_->Draw(scene_, rainy, {});
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_THAT(frame->content.fields, ElementsAre(physics::Hydrometeor::kCloud));
  EXPECT_THAT(frame->content.not_shown,
              testing::Contains(scene::NotShown{scene::NotShown::Code::kFields, "rain"}));
  EXPECT_EQ(frame->slices, 0);
  EXPECT_GT(frame->content.ellipsoids, 0);
  const auto leaves_out_detail = [&] {
    const auto drawn = renderer_->Draw(scene_, rainy, {});
    return std::ranges::any_of(drawn->content.not_shown, [](const scene::NotShown& entry) {
      return entry.code == scene::NotShown::Code::kDetail;
    });
  };
  EXPECT_TRUE(leaves_out_detail());
  scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].detail.share = 0.0F;
  EXPECT_FALSE(leaves_out_detail()) << "the rain's, which is not drawn";
  scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].detail.share = 1.0F;
  test_support::SetTechnique(&scene_.rendering.technique, test_support::kLightVolume);
  EXPECT_FALSE(leaves_out_detail()) << "where it is a setting";
}

TEST_F(SceneRendererTest, KeptStagesGiveThePictureThatAFreshRendererGives) {
  const auto change = [&](int step) {
    switch (step) {
      case 0:
        Orbit().azimuth_deg = 123.0;
        break;
      case 1:
        scene_.sun.azimuth_deg = 20.0;
        break;
      case 2:
        test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
        break;
      case 3:
        scene::MediumSettingsOf(&scene_.rendering.technique)->look.false_colors = true;
        break;
      case 4:
        scene_.fields[0].scale = 0.1F;
        break;
      case 5:
        test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
        break;
      case 6:
        scene_.sky.brightness = 0.2;
        break;
      default:
        scene_.output = {32, 32, 90};
    }
  };
  for (int step = 0; step < 8; ++step) {
    change(step);
    SceneRenderer fresh;
    EXPECT_EQ(Pixels(renderer_.get()), Pixels(&fresh)) << "step " << step;
  }
}

TEST_F(SceneRendererTest, FieldsOutOfSightCostNothing) {
  scene_.fields[0].visible = false;
  const auto frame = renderer_->Draw(scene_, fields_, {});
  ASSERT_TRUE(frame.ok());
  EXPECT_THAT(frame->content.fields, IsEmpty());
  EXPECT_EQ(frame->slices, 0);
  EXPECT_EQ(frame->content.occupied_share, 0.0);
}

TEST_F(SceneRendererTest, ACloudIsBrighterThanTheGroundBehindIt) {
  const std::vector<float> with = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  const std::size_t middle = 4 * (16 * 48 + 24);
  EXPECT_GT(with[middle], 2.0F * without[middle]);
  // The sky in the top corner is unchanged.
  EXPECT_EQ(with[4 * (31 * 48)], without[4 * (31 * 48)]);
}

TEST_F(SceneRendererTest, FromAboveACloudStandsWhereItsCoordinatesSay) {
  // There are 4 km of cloud in the left half of 16 km: its middle is 4 km west of the picture's
  // middle.
  scene_.camera = scene::TopDownCamera{{4000.0, 0.0}, 16e3};
  scene_.sun.elevation_deg = 90.0;  // the shadow lies below the cloud
  const std::vector<float> with = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  for (std::size_t y = 0; y < 32; ++y) {
    for (std::size_t x = 0; x < 48; ++x) {
      const double east_m = 4000.0 + 16e3 * ((static_cast<double>(x) + 0.5) / 48 - 0.5);
      const double north_m = 16e3 * (32.0 / 48.0) * ((static_cast<double>(y) + 0.5) / 32 - 0.5);
      const double outside_m = std::max(std::abs(east_m), std::abs(north_m)) - 2000.0;
      const std::size_t at = 4 * (48 * y + x);
      if (outside_m > 0.0) {
        // The cloud hides up to half of the sky, which gives a tenth of the ground's light.
        ASSERT_NEAR(with[at], without[at], 0.05F * without[at]) << east_m << ' ' << north_m;
      } else if (outside_m < -400.0) {
        ASSERT_GT(with[at], 1.5F * without[at]) << east_m << ' ' << north_m;
      }
    }
  }
}

TEST_F(SceneRendererTest, ASpottersHorizonDips) {
  scene::SpotterCamera camera;
  camera.place_m = {0.0, -60e3};
  camera.eye_height_m = 12000.0;  // the dip of the horizon is sqrt(2 h / R): 3.25 degrees
  camera.azimuth_deg = 180.0;     // looks away from the storm
  camera.elevation_deg = 0.0;
  camera.focal_length_mm = 50.0;
  scene_.camera = camera;
  scene_.sky = {1.0, 0.0, 1.0};
  scene_.output = {8, 400, 90};
  const std::vector<float> pixels = Pixels(renderer_.get());
  // Black ground behind air is darker than the sky above it, so the edge is where brightness falls
  // most.
  const auto row = [&](int y) { return pixels[static_cast<std::size_t>(4 * 8 * y)]; };
  int edge = 100;
  for (int y = 20; y < 380; ++y) {
    if (row(y + 1) / row(y) > row(edge + 1) / row(edge)) edge = y;
  }
  const double dip = std::sqrt(2.0 * 12000.0 / scene::kEffectiveEarthRadius_m);
  EXPECT_NEAR(edge + 1, 200.0 * (1.0 - dip * 50.0 / 12.0), 1.5);
}

// A fixture with a black sky, white ground and no haze. The visible light of the ground is the
// sun's, through air that is the same with and without a cloud.
class GroundTest : public SceneRendererTest {
 protected:
  void SetUp() override {
    SceneRendererTest::SetUp();
    scene_.sky = {0.0, 1.0, 1.0};
    test_support::SetMode(&scene_.rendering.technique, test_support::kLowAlbedo);
    scene_.camera = scene::TopDownCamera{{0.0, 0.0}, 24e3};
    scene_.output = {96, 32, 90};
    scene_.sun = {270.0, 45.0, 1.0};
  }

  // Returns the red value of the pixel at a place on the ground.
  static float At(const std::vector<float>& pixels, double east_m, double north_m) {
    const auto column = static_cast<std::size_t>((east_m / 24e3 + 0.5) * 96);
    const auto row = static_cast<std::size_t>((north_m / 8e3 + 0.5) * 32);
    return pixels[4 * (96 * row + column)];
  }

  // Replaces the fields by a copy of the slab on terrain.
  void SetTerrain(const std::function<double(double east_m, double north_m)>& height_m) {
    auto fields = std::make_shared<volume::HydrometeorFields>(*fields_);
    const volume::RegularGrid& grid = fields->grid;
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const glm::dvec3 middle = grid.low_corner_m + (glm::dvec3(x, y, 0) + 0.5) * grid.spacing_m;
        fields->terrain_height_m.push_back(static_cast<float>(height_m(middle.x, middle.y)));
      }
    }
    fields_ = fields;
  }
};

TEST_F(GroundTest, ACloudsShadowIsItsTransmittance) {
  // The slab is 4 km wide and 2 km high, and the sun is in the west, 45 degrees up. A sun ray that
  // comes down e metres east of the slab's east face has entered the slab through its top or its
  // west face.
  for (const double extinction_per_m : {1e-4, 5e-4, 1e-2}) {
    fields_ = support::MakeSlab(4000.0, 2000.0, extinction_per_m);
    scene_.fields[0].visible = true;
    scene_.fields[0].optics.albedo = 0.0F;  // otherwise scattered light would come through too
    const std::vector<float> with = Pixels(renderer_.get());
    scene_.fields[0].visible = false;
    const std::vector<float> without = Pixels(renderer_.get());
    for (const double beyond_m : {375.0, 875.0, 1375.0}) {
      const double path_m = std::sqrt(2.0) * (2000.0 - beyond_m);
      const double expected = std::exp(-extinction_per_m * path_m);
      // A texel and a sample of the shadow are 125 m long, a pixel of the picture 250 m.
      EXPECT_NEAR(At(with, 2000.0 + beyond_m, 0.0) / At(without, 2000.0 + beyond_m, 0.0), expected,
                  0.01 + 180.0 * extinction_per_m * expected)
          << extinction_per_m << ' ' << beyond_m;
    }
    EXPECT_EQ(At(with, 4875.0, 0.0), At(without, 4875.0, 0.0)) << "beyond the shadow";
    EXPECT_EQ(At(with, -3000.0, 0.0), At(without, -3000.0, 0.0)) << "on the sun's side";
  }
}

TEST_F(GroundTest, SlopesAreLitByTheSunsAngleToThem) {
  scene_.fields[0].visible = false;
  const float level = At(Pixels(renderer_.get()), 0.0, 0.0);
  // The terrain rises to the east by one in four, so the sun in the west is at 45 + 14 degrees from
  // it. The terrain there is only 500 m high, so the air above it dims its light almost as much as
  // that of level ground.
  SetTerrain([](double east_m, double) { return 500.0 + east_m / 4.0; });
  const double facing = std::sin(std::numbers::pi / 4 + std::atan(0.25));
  EXPECT_NEAR(At(Pixels(renderer_.get()), 0.0, 0.0) / level / (facing * std::sqrt(2.0)), 1.0, 0.01);
  // Terrain that falls to the east by two in one is turned away from the sun.
  fields_ = support::MakeSlab(4000.0, 2000.0, 0.01);
  SetTerrain([](double east_m, double) { return 4000.0 - 2.0 * east_m; });
  EXPECT_EQ(At(Pixels(renderer_.get()), 0.0, 0.0), 0.0F);
}

TEST_F(GroundTest, AMountainHidesWhatIsBehindIt) {
  // A wall 6 km high stands between the spotter in the south and the slab.
  scene::SpotterCamera camera;
  camera.place_m = {0.0, -30e3};
  camera.azimuth_deg = 0.0;
  camera.elevation_deg = 2.0;
  camera.focal_length_mm = 60.0;
  scene_.camera = camera;
  for (const auto renderer : {test_support::kHalfAngle, test_support::kLightVolume}) {
    test_support::SetTechnique(&scene_.rendering.technique, renderer);
    const auto storm_shows = [&] {
      scene_.fields[0].visible = true;
      const std::vector<float> with = Pixels(renderer_.get());
      scene_.fields[0].visible = false;
      const std::vector<float> without = Pixels(renderer_.get());
      int different = 0;
      for (std::size_t i = 0; i < with.size(); i += 4) {
        // The storm's darker shadow may be visible. The storm itself would be brighter, because it
        // stands in front of the sky.
        different += with[i] > without[i] + 1e-4F ? 1 : 0;
      }
      return different;
    };
    scene_.sky.brightness = 1.0;
    fields_ = support::MakeSlab(4000.0, 2000.0, 0.01);
    EXPECT_GT(storm_shows(), 50);
    SetTerrain([](double, double north_m) { return north_m < -1700.0 ? 6000.0 : 0.0; });
    EXPECT_EQ(storm_shows(), 0);
  }
}

TEST_F(GroundTest, TerrainThatIsLevelIsDrawnAsAPlane) {
  scene_.camera = scene::OrbitCamera{{0.0, 0.0, 0.0}, 200.0, 20.0, 20e3, 35.0};
  const std::vector<float> plane = Pixels(renderer_.get());
  SetTerrain([](double east_m, double) { return east_m > 0.0 ? 0.0 : 1.5; });
  const std::vector<float> relief = Pixels(renderer_.get());
  for (std::size_t i = 0; i < plane.size(); ++i) {
    if (i % 4 == 3) continue;
    ASSERT_NEAR(relief[i], plane[i], 0.02F * plane[i] + 1e-3F) << i;
  }
}

TEST_F(SceneRendererTest, NightIsDarkAndFinite) {
  scene_.sun.elevation_deg = -30.0;
  const std::vector<float> pixels = Pixels(renderer_.get());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    ASSERT_GE(pixels[i], 0.0F);
    ASSERT_LE(pixels[i], 1e-6F);
  }
}

TEST_F(SceneRendererTest, ACameraInsideTheCloudSeesCloudEverywhere) {
  Orbit().distance_m = 10.0;
  scene_.fields[0].scale = 100.0F;
  const std::vector<float> pixels = Pixels(renderer_.get());
  scene_.fields[0].visible = false;
  const std::vector<float> without = Pixels(renderer_.get());
  float darkest = pixels[0];
  float brightest = pixels[0];
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    ASSERT_TRUE(std::isfinite(pixels[i]));
    ASSERT_NE(pixels[i], without[i]) << i / 4;
    darkest = std::min(darkest, pixels[i]);
    brightest = std::max(brightest, pixels[i]);
  }
  // Deep inside the cloud all directions look alike, unlike the sky and ground of the bare scene.
  EXPECT_GT(darkest, 0.0F);
  EXPECT_LT(brightest, 2.0F * darkest);
}

TEST_F(SceneRendererTest, APictureDoesNotDependOnTheStormBefore) {
  // Draws a block, then two blobs at opposite corners of its box. The volume has the same size, but
  // fewer cells have light.
  const auto block = [](bool corners_alone) {
    auto fields = std::make_shared<volume::HydrometeorFields>(
        *support::MakeSlab(8000.0, 4000.0, 0.01, {32, 32, 16}));
    std::vector<float>& concentration = fields->fields[0].concentration_kg_per_m3;
    for (int z = 0; z < 16; ++z) {
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
          const bool in = std::min({x, y, z + 1}) >= 4 && std::max({x, y, z + 16}) < 28;
          const bool corner = std::max(x, y) < 9 || std::min(x, y) >= 23;
          if (!in || (corners_alone && !corner)) {
            concentration[fields->grid.Offset(x, y, z)] = 0.0F;
          }
        }
      }
    }
    fields->condensate = {{4, 4, 3}, {28, 28, 12}};
    return fields;
  };
  const auto whole = block(false);
  const auto corners = block(true);
  for (const int slices : {5, 16, 64}) {
    scene::SetSlices(&scene_.rendering.technique, slices);
    for (const auto transport : {scene::Transport::kConsistent, scene::Transport::kPaper}) {
      test_support::SetTransport(&scene_.rendering.technique, transport);
      for (const double sun_deg : {20.0, 55.0, 85.0}) {
        scene_.sun.elevation_deg = sun_deg;
        fields_ = whole;
        Pixels(renderer_.get());
        scene_.sun.azimuth_deg += 70.0;
        Pixels(renderer_.get());
        fields_ = corners;
        SceneRenderer fresh;
        EXPECT_EQ(Pixels(renderer_.get()), Pixels(&fresh)) << slices << ' ' << sun_deg;
      }
    }
  }
}

TEST_F(SceneRendererTest, MoreBlocksThanOneRowOfWorkGroupsHolds) {
  // Compares 48 x 48 x 48 blocks of two cells a side with a coarse grid of the same cloud.
  const auto brightness = [&](const glm::ivec3& cells) {
    fields_ = support::MakeSlab(4000.0, 2000.0, 0.01, cells);
    const std::vector<float> pixels = Pixels(renderer_.get());
    return pixels[4 * (16 * 48 + 24)];
  };
  const float fine = brightness({96, 96, 96});
  EXPECT_NEAR(fine / brightness({32, 32, 32}), 1.0F, 0.1F);
}

class ToneMapTest : public ::testing::Test {
 protected:
  static constexpr int kSide_px = 384;

  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok());
    context_ = *std::move(context);
    mapper_ = std::make_unique<frame::ToneMapper>();
    scene_.display.tone_map = scene::ToneMap::kLinear;
    scene_.display.white_balance = false;
  }
  void TearDown() override {
    mapper_.reset();
    context_.reset();
  }

  frame::ToneMapped Map(const gl::Texture2D& linear) {
    absl::StatusOr<frame::ToneMapped> mapped = mapper_->Map(linear, scene_);
    EXPECT_TRUE(mapped.ok()) << mapped.status();
    return *std::move(mapped);
  }

  frame::ToneMapped Map(const picture::LinearPicture& picture) {
    return Map(frame::TextureOf(picture));
  }

  // Returns a grey storm below a bright sky. The left tenth of its rows has another radiance.
  static picture::LinearPicture StormBelowSky(float storm, float left_tenth, float sky) {
    picture::LinearPicture picture;
    picture.size_px = glm::ivec2(kSide_px);
    for (int y = 0; y < kSide_px; ++y) {
      for (int x = 0; x < kSide_px; ++x) {
        const bool is_sky = y < kSide_px / 2;
        const float radiance = is_sky ? sky : x < kSide_px / 10 ? left_tenth : storm;
        picture.radiance.emplace_back(radiance);
        picture.opacity.push_back(is_sky ? 0.0F : 1.0F);
      }
    }
    return picture;
  }

  static constexpr std::size_t kLeftOfStorm = 3 * (3 * kSide_px / 4 * kSide_px + 2);

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<frame::ToneMapper> mapper_;
  scene::Scene scene_;
};

TEST_F(ToneMapTest, MapsKnownRadiances) {
  const gl::Texture2D linear(GL_RGBA32F, {2, 1});
  gl::Framebuffer(linear).Clear(0.0F, 0.5F / frame::kExposureAtZeroEv, 1e6F, 1.0F);
  scene_.display.exposure_ev = 0.0;
  const frame::ToneMapped mapped = Map(linear);
  EXPECT_NEAR(mapped.rgb[0], 0, 1);
  EXPECT_NEAR(mapped.rgb[1], 188, 1);  // sRGB of one half
  EXPECT_NEAR(mapped.rgb[2], 255, 1);
  EXPECT_EQ(mapped.exposure_ev, 0.0);
  scene_.display.exposure_ev = 1.0;
  EXPECT_NEAR(Map(linear).rgb[1], 255, 1);
}

TEST_F(ToneMapTest, FilmHasContrastAToeAndAShoulder) {
  scene_.display.tone_map = scene::ToneMap::kFilmic;
  scene_.display.exposure_ev = 0.0;
  const auto shown = [this](float exposed) {
    const gl::Texture2D grey(GL_RGBA32F, {1, 1});
    const float radiance = exposed / frame::kExposureAtZeroEv;
    gl::Framebuffer(grey).Clear(radiance, radiance, radiance, 1.0F);
    const double coded = Map(grey).rgb[1] / 255.0;
    return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
  };
  // The tone curve itself has a slope of 1 at these values, so the slope of 1.25 comes from the
  // film's contrast.
  EXPECT_NEAR(std::log2(shown(0.62F) / shown(0.4F)) / std::log2(0.62 / 0.4), 1.25, 0.03);
  EXPECT_NEAR(shown(frame::kJustBelowWhite), 0.9, 0.01);
  // On the shoulder, values above "just below white" are brighter but not clipped at once.
  EXPECT_GT(shown(1.5F), shown(1.0F));
  EXPECT_LT(shown(1.5F), 0.999);
  EXPECT_LT(shown(0.04F), 0.5 * shown(0.08F) * std::exp2(-0.35));  // the toe is steeper than this
  EXPECT_GT(shown(0.02F), 0.0);
}

TEST_F(ToneMapTest, TheStormsBrightestHundredthIsJustBelowWhite) {
  scene_.display.tone_map = scene::ToneMap::kFilmic;
  for (const float scale : {0.7F, 4.0F}) {
    // The sky does not count, however bright it is.
    for (const float sky : {0.01F, 3.0F}) {
      const frame::ToneMapped mapped = Map(StormBelowSky(0.05F * scale, 0.3F * scale, sky * scale));
      const double exposed = std::exp2(mapped.exposure_ev) * frame::kExposureAtZeroEv * 0.3 * scale;
      EXPECT_NEAR(exposed, frame::kJustBelowWhite, 0.025 * frame::kJustBelowWhite);
      // The result has the film's contrast and its shoulder, which begins at 0.805.
      const double contrasty =
          frame::kJustBelowWhite * std::pow(exposed / frame::kJustBelowWhite, 1.25);
      const double shown = 1.0 - 0.195 * std::exp((0.805 - contrasty) / 0.195);
      EXPECT_NEAR(mapped.rgb[kLeftOfStorm], 255.0 * (1.055 * std::pow(shown, 1.0 / 2.4) - 0.055),
                  2.0)
          << scale << ' ' << sky;
    }
  }
}

TEST_F(ToneMapTest, SingleBrightPixelsDoNotDarkenAPicture) {
  picture::LinearPicture picture = StormBelowSky(0.1F, 0.1F, 0.05F);
  const double clean_ev = Map(picture).exposure_ev;
  for (std::size_t i = 7; i < picture.radiance.size(); i += 997) picture.radiance[i] *= 20.0F;
  EXPECT_NEAR(Map(picture).exposure_ev, clean_ev, 0.05);
}

TEST_F(ToneMapTest, AStormInShadowStaysDark) {
  const float card = frame::LuminanceOf(frame::WhiteCards().Of(scene_).radiance);
  const double darkest_ev = Map(StormBelowSky(0.01F * card, 0.02F * card, card)).exposure_ev;
  EXPECT_NEAR(std::exp2(darkest_ev) * frame::kExposureAtZeroEv * card, 2.0 * frame::kJustBelowWhite,
              0.01);
}

TEST_F(ToneMapTest, WithoutAStormTheWholePictureCounts) {
  picture::LinearPicture picture = StormBelowSky(0.1F, 0.1F, 0.05F);
  picture.opacity.assign(picture.opacity.size(), 0.0F);
  for (std::size_t i = 0; i < picture.radiance.size() / 4; ++i) picture.radiance[i] *= 8.0F;
  const double expected = frame::kJustBelowWhite / 0.4;
  EXPECT_NEAR(std::exp2(Map(picture).exposure_ev) * frame::kExposureAtZeroEv, expected,
              0.025 * expected);
}

TEST_F(ToneMapTest, AWhiteCardIsNeutralAndASunsetWarm) {
  frame::WhiteCards cards;
  scene_.display.white_balance = true;
  scene_.display.exposure_ev = 0.0;
  for (const double elevation_deg : {60.0, 25.0, 10.5}) {
    scene_.sun.elevation_deg = elevation_deg;
    const gl::Texture2D card(GL_RGBA32F, {1, 1});
    const glm::vec3 radiance = cards.Of(scene_).radiance * 0.4F;
    gl::Framebuffer(card).Clear(radiance.x, radiance.y, radiance.z, 1.0F);
    const frame::ToneMapped mapped = Map(card);
    EXPECT_NEAR(mapped.rgb[0], mapped.rgb[2], 1) << elevation_deg;
    EXPECT_NEAR(mapped.rgb[0], mapped.rgb[1], 1) << elevation_deg;
    EXPECT_GT(mapped.rgb[0], 60);
  }
  scene_.sun.elevation_deg = 2.0;
  const frame::WhiteCard sunset = cards.Of(scene_);
  EXPECT_GT(sunset.radiance.x * sunset.balance.x, 1.3F * sunset.radiance.z * sunset.balance.z);
}

}  // namespace
}  // namespace thunderhead::renderers
