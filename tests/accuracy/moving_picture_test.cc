// Tests of moving pictures, compared with one ray per pixel and fully solved light.
#include "accuracy/moving_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "accuracy/presets.h"
#include "base/device_turn.h"
#include "clouds/cloud_file.h"
#include "clouds/presets.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "gl/whole_target.h"
#include "gtest/gtest.h"
#include "measure/image_error.h"
#include "renderers/scene_renderer.h"
#include "scene/view.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "volume/visible_box.h"

namespace thunderhead::accuracy {
namespace {

using Fields = std::shared_ptr<const volume::HydrometeorFields>;

constexpr glm::ivec2 kSize_px(480, 270);
constexpr FrameQuality kMoving{.sparse = true};

Fields FieldsOf(const std::string& path, int time) {
  auto store = storm_store::StormStore::Open({path}, {});
  EXPECT_TRUE(store.ok()) << store.status();
  auto fields = (*store)->Get((*store)->Storms().front()->id, time, {});
  EXPECT_TRUE(fields.ok()) << fields.status();
  return *std::move(fields);
}

Fields OfSample(const std::string& file, int time) {
  return FieldsOf(THUNDERHEAD_SOURCE_DIR "/samples/" + file, time);
}

class MovingPictureTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    renderer_ = std::make_unique<renderers::SceneRenderer>();
    tone_mapper_ = std::make_unique<frame::ToneMapper>();
    if (gl::ComputesWholeTargets()) GTEST_SKIP() << "this device draws all rays";
  }
  void TearDown() override {
    tone_mapper_.reset();
    renderer_.reset();
    context_.reset();
  }

  void Show(const Fields& fields, const glm::ivec2& size_px = kSize_px) {
    fields_ = fields;
    scene_ = scene::Scene();
    scene_.output.width_px = size_px.x;
    scene_.output.height_px = size_px.y;
    scene_.rendering.technique = TechniqueOf(kDefaultPreset);
    const volume::WorldBox box = volume::VisibleBox(*fields);
    scene_.camera = scene::Framing(scene::OrbitCamera(), box.low_m, box.high_m,
                                   static_cast<double>(size_px.x) / size_px.y);
  }
  scene::OrbitCamera& Orbit() { return std::get<scene::OrbitCamera>(scene_.camera); }

  frame::RgbImage Moving(int* rays = nullptr) {
    const auto coarse = renderer_->Draw(scene_, fields_, MovingQuality(scene_, kMoving));
    EXPECT_TRUE(coarse.ok()) << coarse.status();
    EXPECT_TRUE(coarse->coarse);
    renderers::StageTimes times;
    auto whole = CompleteMoving(
        *coarse, scene_, kMoving, *tone_mapper_,
        [&](const std::vector<glm::vec2>& places) {
          if (rays != nullptr) *rays += static_cast<int>(places.size());
          return renderer_->DrawChosen(places);
        },
        &times);
    EXPECT_TRUE(whole.ok()) << whole.status();
    exposure_ev_ = whole->mapped.exposure_ev;
    return {scene_.output.width_px, scene_.output.height_px, std::move(whole->mapped.rgb)};
  }

  frame::RgbImage AtRest() {
    const auto linear = renderer_->Draw(scene_, fields_, {});
    EXPECT_TRUE(linear.ok()) << linear.status();
    auto mapped = tone_mapper_->Map(*linear->radiance, scene_);
    EXPECT_TRUE(mapped.ok()) << mapped.status();
    exposure_ev_ = mapped->exposure_ev;
    return {scene_.output.width_px, scene_.output.height_px, std::move(mapped->rgb)};
  }

  // Expects that moving pictures use few rays, even if clouds are rough everywhere. At the same
  // exposure their FLIP error must be below 0.02. The exposures that are metered separately must
  // differ by less than 0.15 stops.
  void ExpectAlike(const std::string& what) {
    scene_.display.exposure_ev.reset();
    const frame::RgbImage at_rest = AtRest();
    const double metered_ev = exposure_ev_;
    (void)Moving();
    EXPECT_NEAR(exposure_ev_, metered_ev, 0.15) << what;
    scene_.display.exposure_ev = metered_ev;
    const int pixels = scene_.output.width_px * scene_.output.height_px;
    int rays = pixels / 16;
    EXPECT_LE(measure::Flip(Moving(&rays), at_rest), 0.02) << what;
    EXPECT_LT(rays, most_rays_ * pixels) << what;
  }

  // Checks three sides, low and high.
  void ExpectAlikeAllAround(const std::string& storm) {
    for (const double elevation_deg : {5.0, 45.0}) {
      Orbit().elevation_deg = elevation_deg;
      for (int i = 0; i < 3; ++i) {
        Orbit().azimuth_deg += 120.0;
        ExpectAlike(storm + " from " + std::to_string(Orbit().azimuth_deg) + ", " +
                    std::to_string(elevation_deg));
      }
    }
  }

  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<renderers::SceneRenderer> renderer_;
  std::unique_ptr<frame::ToneMapper> tone_mapper_;
  Fields fields_;
  scene::Scene scene_;
  double exposure_ev_ = 0.0;  // exposure of the last picture
  double most_rays_ = 0.3;    // largest allowed number of rays per pixel
};

TEST_F(MovingPictureTest, LooksLikeARayAPixelOnA500MetreGrid) {
  Show(OfSample("supercell-500m.nc", 2));
  ExpectAlikeAllAround("500 m");
}

TEST_F(MovingPictureTest, LooksLikeARayAPixelOnAKilometreGrid) {
  Show(OfSample("supercell.nc", 3));
  ExpectAlikeAllAround("1 km");
}

TEST_F(MovingPictureTest, LooksLikeARayAPixelOfGeneratedClouds) {
  for (const std::string preset : {"congestus", "cumulus-field"}) {
    const auto shape = clouds::PresetNamed(preset, 1);
    ASSERT_TRUE(shape.ok()) << shape.status();
    const std::string path = testing::TempDir() + "moving_picture_test_" + preset + ".nc";
    const absl::Status written = clouds::WriteGenerated(*shape, {preset, 1}, path, {}, {});
    ASSERT_TRUE(written.ok()) << written;
    Show(FieldsOf(path, 0));
    std::filesystem::remove(path);
    ExpectAlikeAllAround(preset);
  }
}

// In large pictures, neighbouring pixels may differ more before additional rays are drawn. The view
// is from above, which shows differences most.
TEST_F(MovingPictureTest, LargePicturesLookLikeARayAPixelWithEvenFewerRays) {
  Show(OfSample("supercell-500m.nc", 2), {1280, 720});
  EXPECT_NEAR(MovingContrast(scene_), 2.2 * kMovingContrast, 0.1 * kMovingContrast);
  Orbit().elevation_deg = 45.0;
  most_rays_ = 0.1;
  ExpectAlike("500 m");
}

TEST_F(MovingPictureTest, LightOfADraggedSunIsAsGood) {
  for (const std::string file : {"supercell.nc", "supercell-500m.nc"}) {
    Show(OfSample(file, 2));
    // The view is the default, then from above.
    for (const double elevation_deg : {scene::OrbitCamera().elevation_deg, 45.0}) {
      SCOPED_TRACE(file + " from " + std::to_string(elevation_deg));
      Orbit().elevation_deg = elevation_deg;
      scene_.display.exposure_ev.reset();
      (void)AtRest();
      for (int i = 0; i < 3; ++i) {
        scene_.sun.azimuth_deg += 2.0;
        scene_.sun.elevation_deg += 1.0;
        (void)Moving();
      }
      const double metered_ev = exposure_ev_;
      scene_.display.exposure_ev = metered_ev;
      const frame::RgbImage moving = Moving();
      EXPECT_LE(measure::Flip(moving, AtRest()), 0.02);
      scene_.display.exposure_ev.reset();
      (void)AtRest();
      EXPECT_NEAR(exposure_ev_, metered_ev, 0.15);
    }
  }
}

// Compares light that is updated in only a part of the cells with light that is updated in all
// cells.
TEST_F(MovingPictureTest, LightOfASunThatMovesIsFoundInTurns) {
  Show(OfSample("supercell-500m.nc", 2), {240, 135});
  Orbit().elevation_deg = 45.0;
  renderers::SceneRenderer anew;
  const auto off = [&] {
    renderers::DrawQuality quality;
    quality.light_in_turns = true;
    const auto turns = renderer_->Draw(scene_, fields_, quality);
    EXPECT_TRUE(turns.ok()) << turns.status();
    const std::vector<float> found = frame::ReadLinear(*turns->radiance);
    const auto all = anew.Draw(scene_, fields_, {});
    EXPECT_TRUE(all.ok()) << all.status();
    const std::vector<float> wanted = frame::ReadLinear(*all->radiance);
    EXPECT_EQ(found.size(), wanted.size());
    double squares = 0.0;
    double all_squares = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      squares += std::pow(found[i] - wanted[i], 2.0);
      all_squares += std::pow(wanted[i], 2.0);
    }
    return std::sqrt(squares / all_squares);
  };
  const auto move_sun = [&](double degrees) { scene_.sun.azimuth_deg += degrees; };
  EXPECT_LT(off(), 1e-4);  // the first picture updates all cells
  for (int i = 0; i < 6; ++i) {
    move_sun(1.5);
    EXPECT_LT(off(), 3e-3) << i;
  }
  move_sun(60.0);
  EXPECT_LT(off(), 1e-4);
  // After a change of fields, no light of the previous fields remains.
  fields_ = OfSample("supercell-500m.nc", 0);
  EXPECT_LT(off(), 1e-4);
}

// The rays of chosen places must equal those of the picture's pixels, to a step of rounding.
TEST_F(MovingPictureTest, WithARayForEachPixelItIsThePictureAtRest) {
  Show(OfSample("supercell.nc", 1));
  const frame::RgbImage at_rest = AtRest();
  scene_.display.exposure_ev = exposure_ev_;
  renderers::DrawQuality quality = MovingQuality(scene_, kMoving);
  const auto coarse = renderer_->Draw(scene_, fields_, quality);
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  // The image_scale is so large that no contrast is small enough to skip a pixel.
  const FrameQuality all{.image_scale = 1e4, .sparse = true};
  renderers::StageTimes times;
  const auto whole = CompleteMoving(
      *coarse, scene_, all, *tone_mapper_,
      [&](const std::vector<glm::vec2>& places) { return renderer_->DrawChosen(places); }, &times);
  ASSERT_TRUE(whole.ok()) << whole.status();
  int off = 0;
  for (std::size_t i = 0; i < at_rest.rgb.size(); ++i) {
    off += std::abs(whole->mapped.rgb[i] - at_rest.rgb[i]) > 2 ? 1 : 0;
  }
  // The air is computed on fewer rays, and pixels whose neighbours hardly vary are interpolated
  // from them.
  EXPECT_LE(off, static_cast<int>(at_rest.rgb.size() / 200));
}

// Small moving pictures are drawn as chosen rays. Detail and the ground's pattern would match
// pixels of another size, and the air is computed on other rays.
TEST_F(MovingPictureTest, CoarsePicturesAreThePicturesOfTheirSize) {
  const Fields level = OfSample("supercell.nc", 1);
  // The ground is high and slopes, and hides the lower half of the storm.
  auto hilly = std::make_shared<volume::HydrometeorFields>(*level);
  hilly->terrain_height_m.clear();
  const glm::ivec3& cells = hilly->grid.cells;
  for (int y = 0; y < cells.y; ++y) {
    hilly->terrain_height_m.insert(hilly->terrain_height_m.end(), static_cast<std::size_t>(cells.x),
                                   6000.0F + 5.0F * static_cast<float>(y));
  }
  for (const auto& [fields, size_px] :
       {std::pair(level, glm::ivec2(300, 300)), std::pair(level, glm::ivec2(312, 152)),
        std::pair(level, glm::ivec2(640, 360)), std::pair(Fields(hilly), glm::ivec2(300, 300))}) {
    Show(fields, size_px);
    std::get<scene::LightVolume>(scene_.rendering.technique).medium.look.detail = false;
    renderers::DrawQuality quality = MovingQuality(scene_, kMoving);
    const auto coarse = renderer_->Draw(scene_, fields_, quality);
    ASSERT_TRUE(coarse.ok()) << coarse.status();
    ASSERT_TRUE(coarse->coarse);
    const std::vector<float> found = frame::ReadLinear(*coarse->radiance);
    const glm::ivec2 coarse_px = coarse->radiance->Size();
    scene_.output.width_px = coarse_px.x;
    scene_.output.height_px = coarse_px.y;
    quality.coarse_px.reset();
    const auto plain = renderer_->Draw(scene_, fields_, quality);
    ASSERT_TRUE(plain.ok()) << plain.status();
    ASSERT_EQ(plain->radiance->Size(), coarse_px);
    const std::vector<float> wanted = frame::ReadLinear(*plain->radiance);
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_NEAR(found[i], wanted[i], 0.003F * wanted[i] + 1e-4F) << size_px.x << " " << i;
    }
  }
}

// A device turn that counts how often it is taken. It must be given back before it is taken again.
class SingleTurns final : public base::DeviceTurn {
 public:
  absl::Status Take() override {
    EXPECT_FALSE(held_) << "taken twice";
    held_ = true;
    ++taken_;
    return absl::OkStatus();
  }
  void GiveBack() override { held_ = false; }

  int Taken() const { return taken_; }

 private:
  bool held_ = false;
  int taken_ = 0;
};

// The CPU works on the picture before each drawing of rays, and after the last drawing. The device
// must be free for other work meanwhile.
TEST_F(MovingPictureTest, OthersMayDrawWhileTheProcessorsCompleteIt) {
  Show(OfSample("supercell.nc", 1));
  scene_.output.width_px = 1600;
  scene_.output.height_px = 900;
  SingleTurns turn;
  const auto programs = std::make_shared<gl::ProgramCache>(&turn);
  renderers::SceneRenderer renderer(programs);
  frame::ToneMapper tone_mapper(programs);
  renderers::StageTimes times;
  const auto whole = programs->Pieces().During([&]() -> absl::StatusOr<CompletedPicture> {
    const auto coarse = renderer.Draw(scene_, fields_, MovingQuality(scene_, kMoving));
    if (!coarse.ok()) return coarse.status();
    int before = turn.Taken();
    auto completed = CompleteMoving(
        *coarse, scene_, kMoving, tone_mapper,
        [&](const std::vector<glm::vec2>& places) {
          EXPECT_GT(turn.Taken(), before) << "it was held since the last drawing";
          auto drawn = renderer.DrawChosen(places);
          before = turn.Taken();
          return drawn;
        },
        &times);
    EXPECT_GT(turn.Taken(), before) << "it was held after the last drawing";
    return completed;
  });
  ASSERT_TRUE(whole.ok()) << whole.status();
}

TEST_F(MovingPictureTest, WithMoreBitsItIsTheSamePicture) {
  Show(OfSample("supercell.nc", 1));
  const auto coarse = renderer_->Draw(scene_, fields_, MovingQuality(scene_, kMoving));
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  renderers::StageTimes times;
  const auto whole = CompleteMoving(
      *coarse, scene_, kMoving, *tone_mapper_,
      [&](const std::vector<glm::vec2>& places) { return renderer_->DrawChosen(places); }, &times);
  ASSERT_TRUE(whole.ok()) << whole.status();
  ASSERT_EQ(whole->fine.rgb.size(), whole->mapped.rgb.size());
  for (std::size_t i = 0; i < whole->fine.rgb.size(); ++i) {
    ASSERT_NEAR(whole->fine.rgb[i] / 257.0, whole->mapped.rgb[i], 1.01);
  }
}

TEST(MovingSize, PicturesUpToTheLimitKeepTheirsAndLargerOnesTheirShape) {
  scene::Scene scene;
  for (const glm::ivec2 size : {glm::ivec2(1600, 900), glm::ivec2(1, 1), glm::ivec2(1, 8192)}) {
    scene.output.width_px = size.x;
    scene.output.height_px = size.y;
    EXPECT_EQ(MovingOutputScale(scene), 1.0) << size.x;
    EXPECT_EQ(WithOutputScale(scene, 1.0), scene);
  }
  scene.output.width_px = 8192;
  scene.output.height_px = 4096;
  const scene::Scene moving = WithOutputScale(scene, MovingOutputScale(scene));
  EXPECT_NEAR(moving.output.width_px, 2.0 * moving.output.height_px, 1.0);
  EXPECT_NEAR(1.0 * moving.output.width_px * moving.output.height_px, kMaxMovingPixels,
              0.002 * kMaxMovingPixels);
}

TEST_F(MovingPictureTest, AtRestThePictureIsAsIfNothingHadMoved) {
  Show(OfSample("supercell.nc", 1));
  const frame::RgbImage before = AtRest();
  Orbit().azimuth_deg += 10.0;
  (void)Moving();
  Orbit().azimuth_deg -= 10.0;
  EXPECT_EQ(AtRest().rgb, before.rgb);
}

}  // namespace
}  // namespace thunderhead::accuracy
