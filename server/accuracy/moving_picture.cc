#include "accuracy/moving_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>

#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/sparse_picture.h"
#include "gl/pieces.h"
#include "renderers/chosen_rays.h"

namespace thunderhead::accuracy {
namespace {

constexpr std::size_t kChannels = 3;

// Above kMovingContrastPixels, the contrast limit grows with the number of pixels to the power of
// kContrastGrowth, up to the factor kMostContrast.
constexpr double kContrastGrowth = 0.4;
constexpr double kMostContrast = 2.25;

// Returns the colours of the rays of `frame`, in the order in which they were chosen.
absl::StatusOr<std::vector<std::uint16_t>> ColorsOf(const renderers::ChosenFrame& frame,
                                                    std::size_t count,
                                                    frame::ToneMapper& tone_mapper) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::FineImage picture,
                               tone_mapper.MapFine(*frame.radiance, frame.part_px));
  const glm::ivec2 size = frame.part_px;
  const std::vector<std::uint16_t>& pixels = picture.rgb;
  std::vector<std::uint16_t> colors;
  colors.reserve(kChannels * count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::ivec2 pixel = renderers::ChosenRays::PixelOf(i);
    const auto row = static_cast<std::size_t>(size.y - 1 - pixel.y);
    const std::size_t at =
        kChannels * (row * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(pixel.x));
    colors.insert(colors.end(), {pixels[at], pixels[at + 1], pixels[at + 2]});
  }
  return colors;
}

void Add(const renderers::StageTimes& more, renderers::StageTimes* sums) {
  for (const scene::StageTime& time : more) {
    const auto same = std::ranges::find(*sums, time.stage, &scene::StageTime::stage);
    if (same == sums->end()) {
      sums->push_back(time);
    } else {
      same->milliseconds += time.milliseconds;
    }
  }
}

double Sum_ms(const renderers::StageTimes& times) {
  double sum_ms = 0.0;
  for (const scene::StageTime& time : times) sum_ms += time.milliseconds;
  return sum_ms;
}

}  // namespace

double MovingContrast(const scene::Scene& scene) {
  const double pixels = 1.0 * scene.output.width_px * scene.output.height_px;
  return kMovingContrast *
         std::clamp(std::pow(pixels / kMovingContrastPixels, kContrastGrowth), 1.0, kMostContrast);
}

double MovingOutputScale(const scene::Scene& scene) {
  const double pixels = 1.0 * scene.output.width_px * scene.output.height_px;
  return std::min(std::sqrt(kMaxMovingPixels / pixels), 1.0);
}

scene::Scene WithOutputScale(const scene::Scene& scene, double output_scale) {
  const auto scaled = [&](int pixels) {
    return std::max(static_cast<int>(std::lround(output_scale * pixels)), 1);
  };
  scene::Scene smaller = scene;
  smaller.output.width_px = scaled(scene.output.width_px);
  smaller.output.height_px = scaled(scene.output.height_px);
  return smaller;
}

bool MovesSparsely(const scene::Scene& scene) {
  return scene::CapabilitiesOf(scene.rendering.technique).sparse;
}

renderers::DrawQuality MovingQuality(const scene::Scene& scene, const FrameQuality& quality) {
  renderers::DrawQuality drawn{quality.image_scale, quality.slice_share};
  if (!MovesSparsely(scene)) return drawn;
  drawn.coarse_px = frame::CoarsestOf({scene.output.width_px, scene.output.height_px});
  drawn.light_tolerance = kMovingLightTolerance;
  drawn.light_layer = kMovingLightLayer;
  drawn.light_in_turns = true;
  drawn.quick_water_paths = true;
  return drawn;
}

absl::StatusOr<CompletedPicture> CompleteMoving(
    const renderers::LinearFrame& coarse, const scene::Scene& scene, const FrameQuality& quality,
    frame::ToneMapper& tone_mapper, const DrawChosen& draw, renderers::StageTimes* stages) {
  gl::Pieces& pieces = tone_mapper.Pieces();
  const base::Stopwatch stopwatch;
  const double waited_ms = pieces.WaitedMs();
  CompletedPicture whole;
  frame::ToneMapped& mapped = whole.mapped;
  THUNDERHEAD_ASSIGN_OR_RETURN(mapped.exposure_ev, tone_mapper.SetTone(*coarse.radiance, scene));
  THUNDERHEAD_ASSIGN_OR_RETURN(frame::FineImage coarsest, tone_mapper.MapFine(*coarse.radiance));
  double drawing_ms = 0.0;
  const auto draw_places =
      [&](const std::vector<glm::vec2>& places) -> absl::StatusOr<std::vector<std::uint16_t>> {
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::ChosenFrame chosen, draw(places));
    Add(chosen.stages, stages);
    drawing_ms += Sum_ms(chosen.stages);
    return ColorsOf(chosen, places.size(), tone_mapper);
  };
  // With a smaller image_scale, each ray represents more pixels, so the contrast limit grows in
  // proportion.
  const double contrast = MovingContrast(scene) / (quality.image_scale * quality.image_scale);
  // Most of this work runs on the CPU, so other drawings may use the device meanwhile.
  absl::StatusOr<frame::FineImage> completed;
  THUNDERHEAD_RETURN_IF_ERROR(pieces.OffTurn([&] {
    completed =
        frame::CompletePicture(std::move(coarsest), {scene.output.width_px, scene.output.height_px},
                               contrast, [&](const std::vector<glm::vec2>& places) {
                                 return pieces.During([&] { return draw_places(places); });
                               });
    if (completed.ok()) mapped.rgb = frame::Dithered(*completed);
  }));
  THUNDERHEAD_ASSIGN_OR_RETURN(whole.fine, std::move(completed));
  mapped.tone_ms = stopwatch.ElapsedMs() - (pieces.WaitedMs() - waited_ms) - drawing_ms;
  return whole;
}

}  // namespace thunderhead::accuracy
