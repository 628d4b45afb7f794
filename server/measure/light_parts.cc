#include "measure/light_parts.h"

#include "accuracy/named_settings.h"

#include <utility>

#include "base/status.h"
#include "frame/tone_map.h"

namespace thunderhead::measure {
namespace {

// Averages blocks of `side` x `side` pixels.
picture::LinearPicture Averaged(const picture::LinearPicture& image, int side) {
  picture::LinearPicture mean{image.size_px / side, {}};
  const auto width = static_cast<std::size_t>(mean.size_px.x);
  mean.radiance.resize(width * static_cast<std::size_t>(mean.size_px.y));
  const float share = 1.0F / static_cast<float>(side * side);
  for (int y = 0; y < mean.size_px.y * side; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size_px.x);
    for (int x = 0; x < mean.size_px.x * side; ++x) {
      mean.radiance[static_cast<std::size_t>(y / side) * width +
                    static_cast<std::size_t>(x / side)] +=
          share * image.radiance[row + static_cast<std::size_t>(x)];
    }
  }
  return mean;
}

absl::StatusOr<picture::LinearPicture> Draw(
    renderers::SceneRenderer& renderer, const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const renderers::DrawQuality& quality, int finer) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame frame,
                               renderer.Draw(scene, fields, quality));
  return Averaged(frame::PictureOf(*frame.radiance), finer);
}

}  // namespace

std::string NameOf(LightPart part) {
  switch (part) {
    case LightPart::kOnce:
      return "once";
    case LightPart::kSun:
      return "sun";
    case LightPart::kSky:
      return "sky";
    case LightPart::kAll:
      return "all";
  }
  THUNDERHEAD_CHECK(false, "unknown part");
}

scene::Scene SceneOf(LightPart part, scene::Scene scene) {
  if (part == LightPart::kAll) return scene;
  scene.sky.ground_albedo = 0.0;
  if (part == LightPart::kSky) return scene;
  scene.sky.brightness = 0.0;
  if (part == LightPart::kSun) return scene;
  scene.rendering.technique =
      accuracy::InMode(scene.rendering.technique, accuracy::kUniformPhaseLowAlbedoMode,
                       scene::Transport::kConsistent);
  return scene;
}

reference::TraceOptions TraceOptionsOf(LightPart part, double peak_cut_deg) {
  reference::TraceOptions options;
  options.peak_cut_deg = part == LightPart::kOnce ? 0.0 : peak_cut_deg;
  options.max_scatterings = part == LightPart::kOnce ? 1 : 0;
  options.sun = part != LightPart::kSky;
  return options;
}

absl::StatusOr<picture::LinearPicture> DrawPart(
    renderers::SceneRenderer& renderer, const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields, LightPart part, int finer,
    std::shared_ptr<const renderers::LightCorrection> correction) {
  renderers::DrawQuality quality;
  quality.correction = std::move(correction);
  scene::Scene lit = SceneOf(part, scene);
  lit.output.width_px *= finer;
  lit.output.height_px *= finer;
  THUNDERHEAD_ASSIGN_OR_RETURN(picture::LinearPicture image,
                               Draw(renderer, lit, fields, quality, finer));
  if (part != LightPart::kSky) return image;
  // Light is additive, so the skylight is the difference from a picture with a black sky.
  lit.sky.brightness = 0.0;
  THUNDERHEAD_ASSIGN_OR_RETURN(const picture::LinearPicture sun,
                               Draw(renderer, lit, fields, quality, finer));
  for (std::size_t i = 0; i < image.radiance.size(); ++i) image.radiance[i] -= sun.radiance[i];
  return image;
}

}  // namespace thunderhead::measure
