// Tests of views from inside clouds. The picture must not change abruptly when the camera moves, no
// cloud may be clipped near the camera, and fog must show no bands.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "frame/tone_map.h"
#include "frame/white_balance.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "renderers/scene_renderer.h"
#include "storm_store/storm_store.h"
#include "tests/accuracy/slab_view.h"
#include "tests/support/gl_context.h"

namespace thunderhead::renderers {
namespace {

constexpr int kWidth_px = 72;
constexpr int kHeight_px = 48;
constexpr int kManySlices = 2048;
constexpr double kWallLuminance = 0.28;

struct Eye {
  glm::dvec3 place_m;
  double azimuth_deg;
  double elevation_deg;
};

// The path lies on the updraught's western side, which is sunlit. It leads from outside into the
// cloud.
constexpr int kSteps = 24;
constexpr double kStep_m = 50.0;
Eye OnPath(double step) { return {{-14600.0 + step * kStep_m, -2750.0, 5000.0}, 80.0, 5.0}; }

class InteriorsTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
    auto store =
        storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc"}, {});
    ASSERT_TRUE(store.ok()) << store.status();
    auto fields = (*store)->Get((*store)->Storms().front()->id, 2, {});
    ASSERT_TRUE(fields.ok()) << fields.status();
    fields_ = *std::move(fields);
    renderer_ = std::make_unique<SceneRenderer>();
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    fields_.reset();
    context_.reset();
  }

  // Returns luminances of the default look, in units of the cloud wall's luminance.
  static std::vector<double> Draw(const Eye& eye, int slices = 128) {
    scene::Scene scene;
    scene.output = {kWidth_px, kHeight_px, 90};
    scene.sun = {255.0, 35.0};
    scene::SpotterCamera camera;
    camera.place_m = glm::dvec2(eye.place_m);
    camera.eye_height_m = eye.place_m.z;
    camera.azimuth_deg = eye.azimuth_deg;
    camera.elevation_deg = eye.elevation_deg;
    scene.camera = camera;
    scene::SetSlices(&scene.rendering.technique, slices);
    const auto frame = renderer_->Draw(scene, fields_, {});
    EXPECT_TRUE(frame.ok()) << frame.status();
    const picture::LinearPicture picture = frame::PictureOf(*frame->radiance);
    std::vector<double> luminances;
    luminances.reserve(picture.radiance.size());
    for (const glm::vec3& radiance : picture.radiance) {
      luminances.push_back(double{frame::LuminanceOf(radiance)} / kWallLuminance);
      EXPECT_TRUE(std::isfinite(luminances.back()));
    }
    return luminances;
  }

  static double MeanOf(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }

  static double RmsOf(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(squares / static_cast<double>(a.size()));
  }

 private:
  inline static std::unique_ptr<gl::Context> context_;
  inline static std::shared_ptr<const volume::HydrometeorFields> fields_;
  inline static std::unique_ptr<SceneRenderer> renderer_;
};

// Returns the mean of each row.
std::vector<double> RowsOf(const std::vector<double>& values) {
  std::vector<double> rows(kHeight_px, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) rows[i / kWidth_px] += values[i] / kWidth_px;
  return rows;
}

TEST_F(InteriorsTest, NothingPopsAsTheCameraMoves) {
  std::vector<std::vector<double>> frames;
  frames.reserve(kSteps);
  for (int step = 0; step < kSteps; ++step) frames.push_back(Draw(OnPath(step)));
  double worst_mean = 0.0;
  double squares = 0.0;
  for (int step = 1; step + 1 < kSteps; ++step) {
    std::vector<double> between;
    for (std::size_t i = 0; i < frames[0].size(); ++i) {
      between.push_back((frames[step - 1][i] + frames[step + 1][i]) / 2.0);
    }
    worst_mean = std::max(worst_mean, std::abs(MeanOf(frames[step]) - MeanOf(between)));
    squares += std::pow(RmsOf(frames[step], between), 2) / (kSteps - 2);
  }
  EXPECT_LT(worst_mean, 0.004);
  // If samples were as far apart near the eye as elsewhere, this would be 0.041.
  EXPECT_LT(std::sqrt(squares), 0.03);
}

TEST_F(InteriorsTest, FewSamplesShowNoPlatesOrBands) {
  for (const int step : {0, 6, 12, 18, 23}) {
    const std::vector<double> usual = Draw(OnPath(step));
    const std::vector<double> many = Draw(OnPath(step), kManySlices);
    // If samples were as far apart near the eye as elsewhere, the root mean square would be up to
    // 0.13. The difference between neighbouring rows, checked below, would be up to 0.05.
    EXPECT_LT(RmsOf(usual, many), 0.04) << step;
    const std::vector<double> rows = RowsOf(usual);
    const std::vector<double> ideal = RowsOf(many);
    for (std::size_t y = 1; y < rows.size(); ++y) {
      EXPECT_NEAR(rows[y] - rows[y - 1], ideal[y] - ideal[y - 1], 0.03) << step << " " << y;
    }
  }
}

TEST_F(InteriorsTest, AMetreChangesLittle) {
  for (int step = 0; step < kSteps; step += 4) {
    const std::vector<double> here = Draw(OnPath(step));
    const std::vector<double> there = Draw(OnPath(step + 1.0 / kStep_m));
    for (std::size_t i = 0; i < here.size(); ++i) {
      // The cloud's rim in front of the sky moves by a fraction of a pixel.
      EXPECT_NEAR(here[i], there[i], 0.1) << step;
    }
  }
}

class InSlab : public SlabView {};

TEST_F(InSlab, NothingIsClippedBeforeTheEye) {
  scene_.rendering.technique = accuracy::Plain<scene::LightVolume>().settings();
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  constexpr double kDepth = 40.0;  // optical depth of the slab, which is 1000 m thick
  for (const double height_m : {1.0, 5.0, 30.0, 100.0}) {
    scene::OrbitCamera camera;  // looks down through the slab's lower face
    camera.target_m = {0.0, 0.0, 0.0};
    camera.azimuth_deg = kViewAzimuth_deg;
    camera.elevation_deg = 89.9;
    camera.distance_m = height_m;
    camera.field_of_view_deg = 2.0;
    const double seen = Look(kDepth, scene::ViewOf(camera, 1.0), 45.0).transmittance;
    EXPECT_NEAR(seen, std::exp(-kDepth * height_m / kHeight_m), kTextureError) << height_m;
  }
}

}  // namespace
}  // namespace thunderhead::renderers
