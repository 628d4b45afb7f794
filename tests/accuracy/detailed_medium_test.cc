// Tests of the medium with detail as computed without GL, compared with what is drawn.
#include "scene/detailed_medium.h"

#include <cmath>
#include <memory>

#include "accuracy/named_settings.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "renderers/scene_renderer.h"
#include "scene/drawn_fields.h"
#include "storm_store/storm_store.h"
#include "tests/support/gl_context.h"
#include "tests/support/techniques.h"
#include "volume/strongest_core.h"

namespace thunderhead {
namespace {

std::shared_ptr<const volume::HydrometeorFields> Sample() {
  const auto store =
      *storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc"}, {});
  return *store->Get(store->Storms().front()->id, 0, {});
}

// The storm is seen straight down, in pixels so small that no detail fades. It is thin enough for
// light to pass, so transmittances are compared.
TEST(DetailedMedium, IsWhatTheLightVolumeDraws) {
  constexpr int kSide_px = 72;
  constexpr double kWidth_m = 6000.0;
  auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok()) << context.status();
  const auto fields = Sample();
  const auto core = volume::StrongestCore(*fields);
  ASSERT_TRUE(core.has_value());
  scene::Scene scene = test_support::PlainScene();
  // Delta scaling is off, so the eye sees the medium's own extinction.
  test_support::SetMode(&scene.rendering.technique, test_support::kLowAlbedo);
  auto& technique = std::get<scene::LightVolume>(scene.rendering.technique);
  technique.medium.look.detail = true;
  scene::SetSlices(&scene.rendering.technique, 4096);
  for (scene::FieldParameters& field : scene.fields) field.scale = 0.3F;
  scene.output = {kSide_px, kSide_px, 90};
  const glm::dvec2 middle_m = core->place_m - glm::dvec2(5500.0, 0.0);
  scene.camera = scene::TopDownCamera{middle_m, kWidth_m};
  renderers::SceneRenderer renderer;
  renderers::DrawQuality quality;
  quality.single_precision = true;
  const auto frame = renderer.Draw(scene, fields, quality);
  ASSERT_TRUE(frame.ok()) << frame.status();
  const picture::LinearPicture picture = frame::PictureOf(*frame->radiance);

  const auto medium = scene::DetailedMedium::Of(scene, *fields);
  const volume::RegularGrid& grid = fields->grid;
  const double step_m = grid.spacing_m.z / 8.0;
  const double pixel_m = kWidth_m / kSide_px;
  double off = 0.0;
  double off_without = 0.0;  // difference from the medium without detail, for scale
  double covered = 0.0;
  scene::Scene plain = scene;
  for (scene::FieldParameters& field : plain.fields) field.detail.share = 0.0F;
  const auto smooth = scene::DetailedMedium::Of(plain, *fields);
  for (int y = 0; y < kSide_px; ++y) {
    for (int x = 0; x < kSide_px; ++x) {
      const glm::dvec2 place_m =
          middle_m + glm::dvec2(x + 0.5 - kSide_px / 2.0, kSide_px / 2.0 - y - 0.5) * pixel_m;
      double depth = 0.0;
      double depth_without = 0.0;
      for (double z_m = grid.low_corner_m.z + step_m / 2; z_m < grid.HighCorner_m().z;
           z_m += step_m) {
        for (const float value : medium->At_per_m({place_m, z_m})) depth += value * step_m;
        for (const float value : smooth->At_per_m({place_m, z_m})) depth_without += value * step_m;
      }
      const double opacity = picture.opacity[static_cast<std::size_t>(y * kSide_px + x)];
      off += std::abs(opacity - (1.0 - std::exp(-depth)));
      off_without += std::abs(opacity - (1.0 - std::exp(-depth_without)));
      covered += opacity;
    }
  }
  constexpr double kPixels = kSide_px * kSide_px;
  EXPECT_GT(covered / kPixels, 0.1);
  EXPECT_LT(covered / kPixels, 0.95);
  // The tolerance covers that rays end at a transmittance of 0.005, and that llvmpipe interpolates
  // byte textures with 8 bits.
  EXPECT_LT(off / kPixels, 0.004);
  // Seen straight down, columns of cells contain the same amount with and without detail.
  EXPECT_GT(off_without, 5.0 * off);
}

// The billows move with the wind while the storm itself stays.
TEST(DetailedMedium, DriftsWithTheWind) {
  volume::HydrometeorFields fields = *Sample();
  const auto core = volume::StrongestCore(fields);
  ASSERT_TRUE(core.has_value());
  scene::Scene scene = test_support::PlainScene();
  test_support::SetMode(&scene.rendering.technique, test_support::kLowAlbedo);
  std::get<scene::LightVolume>(scene.rendering.technique).medium.look.detail = true;
  const double top_m = fields.grid.HighCorner_m().z;
  const auto cloud_at = [&](double time_s, const glm::dvec2& wind_m_per_s) {
    fields.motion.time_s = time_s;
    fields.motion.steering_m_per_s = wind_m_per_s;
    const auto medium = scene::DetailedMedium::Of(scene, fields);
    std::vector<float> values;
    for (double z_m = fields.grid.low_corner_m.z; z_m < top_m; z_m += 200.0) {
      for (double x_m = -8000.0; x_m < 2000.0; x_m += 500.0) {
        values.push_back(medium->At_per_m({core->place_m + glm::dvec2(x_m, 0.0), z_m})[0]);
      }
    }
    return values;
  };
  const auto difference = [](const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0.0;
    double of_a = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += std::abs(static_cast<double>(a[i] - b[i]));
      of_a += static_cast<double>(a[i]);
    }
    return sum / of_a;
  };
  const glm::dvec2 wind(12.0, 5.0);
  const std::vector<float> first = cloud_at(0.0, wind);
  EXPECT_EQ(difference(first, cloud_at(600.0, {0.0, 0.0})), 0.0);
  const double soon = difference(first, cloud_at(5.0, wind));
  EXPECT_GT(soon, 0.0);
  EXPECT_LT(soon, 0.5 * difference(first, cloud_at(600.0, wind)));
  // At this time the wind has moved the noise by a whole period.
  EXPECT_LT(difference(first, cloud_at(10795.0, wind)), 2.0 * soon);
}

}  // namespace
}  // namespace thunderhead
