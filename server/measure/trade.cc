#include "measure/trade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "accuracy/named_settings.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "device_paths/device_tracer.h"
#include "measure/image_error.h"

namespace thunderhead::measure {
namespace {

constexpr int kTimedFrames = 9;

double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

scene::Technique LightVolume(scene::Transport transport,
                             const accuracy::Mode& mode = accuracy::kPerFieldPhaseTranslucentMode) {
  return InMode(accuracy::Plain<scene::LightVolume>().settings(), mode, transport);
}

Setting WithCount(scene::Technique technique, int count) {
  scene::SetCount(&technique, count);
  return {technique};
}

// Adds variants of the light volume in which each field has its own phase function.
void AddVariants(scene::Transport transport, std::vector<Setting>* settings) {
  const Setting usual{LightVolume(transport)};
  for (const double scale : {0.25, 0.5, 0.75}) {
    for (const int slices : {32, 64, 128}) {
      settings->push_back(WithCount(usual.technique, slices));
      settings->back().image_scale = scale;
    }
  }
  settings->push_back(usual);
  settings->back().image_scale = 2.0;
  for (const double detail : {0.5, 2.0}) {
    settings->push_back(usual);
    settings->back().light_detail = detail;
  }
  settings->push_back(usual);
  settings->back().single_precision = true;
  for (const int quality : {30, 60, 95}) {
    settings->push_back(usual);
    settings->back().jpeg_quality = quality;
  }
}

// Moves the camera by a distance too small to be visible, so that the view stage runs again.
void Nudge(scene::Camera* camera) {
  constexpr double kStep = 1e-9;
  std::visit(
      [](auto& view) {
        if constexpr (requires { view.azimuth_deg; }) {
          view.azimuth_deg += kStep;
        } else {
          view.width_m *= 1.0 + kStep;
        }
      },
      *camera);
}

}  // namespace

std::vector<Setting> DefaultSweep(const std::vector<double>& million_paths) {
  using scene::Transport;
  constexpr std::array kCounts = {32, 64, 128, 256, 512};
  std::vector<Setting> settings;
  const auto add = [&](const scene::Technique& technique, const auto& counts) {
    for (const int count : counts) settings.push_back(WithCount(technique, count));
  };
  using accuracy::kPerFieldPhaseTranslucentMode;
  using accuracy::kUniformPhaseLowAlbedoMode;
  using accuracy::kUniformPhaseTranslucentMode;
  for (const accuracy::PlainTechnique& plain :
       {accuracy::Plain<scene::LightVolume>(), accuracy::Plain<scene::HalfAngle>()}) {
    for (const accuracy::Mode& mode : {kPerFieldPhaseTranslucentMode, kUniformPhaseTranslucentMode,
                                       kUniformPhaseLowAlbedoMode}) {
      for (const Transport transport : {Transport::kConsistent, Transport::kPaper}) {
        add(accuracy::InMode(plain.settings(), mode, transport), kCounts);
      }
    }
  }
  for (const accuracy::Mode& mode : {kPerFieldPhaseTranslucentMode, kUniformPhaseTranslucentMode}) {
    add(LightVolume(Transport::kDiffusion, mode), kCounts);
  }
  for (const Transport transport : {Transport::kConsistent, Transport::kPaper}) {
    add(scene::Metaballs{.medium = {.transport = transport}}, std::array{300, 1200, 3000, 10000});
  }
  for (const Transport transport : {Transport::kConsistent, Transport::kDiffusion}) {
    AddVariants(transport, &settings);
  }
  for (const double paths : million_paths) {
    Setting traced{LightVolume(Transport::kDiffusion)};
    traced.million_paths = paths;
    for (const double scale : {1.0, 2.0}) {
      traced.image_scale = scale;
      settings.push_back(traced);
    }
  }
  return settings;
}

std::vector<Setting> TransportSweep(const std::vector<double>& million_paths) {
  std::vector<Setting> settings{{LightVolume(scene::Transport::kConsistent)},
                                {LightVolume(scene::Transport::kDiffusion)}};
  for (const double paths : million_paths) {
    settings.push_back(settings[1]);
    settings.back().million_paths = paths;
  }
  return settings;
}

void MarkPareto(std::vector<TradeRow>* rows) {
  for (TradeRow& row : *rows) {
    row.pareto = std::none_of(rows->begin(), rows->end(), [&](const TradeRow& other) {
      const bool no_worse =
          other.milliseconds <= row.milliseconds && other.relative_rmse <= row.relative_rmse;
      return no_worse &&
             (other.milliseconds < row.milliseconds || other.relative_rmse < row.relative_rmse);
    });
  }
}

scene::Scene ReferenceScene(scene::Scene scene) {
  scene.rendering.technique = scene::Reference{};
  return scene;
}

Trade::Trade(scene::Scene scene, std::shared_ptr<const volume::HydrometeorFields> fields,
             ReferenceComparison comparison, double error_seconds)
    : scene_(std::move(scene)),
      fields_(std::move(fields)),
      comparison_(std::move(comparison)),
      error_seconds_(error_seconds) {
  scene_.output.width_px = comparison_.Reference().size_px.x;
  scene_.output.height_px = comparison_.Reference().size_px.y;
}

absl::StatusOr<frame::RgbImage> Trade::Display(const gl::Texture2D& linear) {
  THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped, tone_mapper_.Map(linear, scene_));
  return frame::RgbImage{linear.Size().x, linear.Size().y, std::move(mapped.rgb)};
}

absl::StatusOr<std::shared_ptr<const renderers::LightCorrection>> Trade::CorrectionOf(
    const scene::Scene& scene, double million_paths, const std::stop_token& stop) {
  if (million_paths <= 0.0) return nullptr;
  scene::Scene traced = scene;
  scene::SetTracedLight(&traced.rendering.technique, scene::TracedLight::kAtRest);
  if (!accuracy::TracesLight(traced, *fields_)) return nullptr;
  if (corrector_ == nullptr || !corrector_->Serves(traced, fields_) ||
      corrected_by_ > million_paths) {
    THUNDERHEAD_ASSIGN_OR_RETURN(corrector_,
                                 accuracy::LightCorrector::Create(traced, fields_, programs_, 0));
    corrected_by_ = 0.0;
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      corrector_->TraceUntil(std::llround(1e6 * million_paths), stop, nullptr));
  corrected_by_ = million_paths;
  return corrector_->Correction();
}

absl::Status Trade::Estimate(const scene::Scene& scene, const picture::LinearPicture& image,
                             const std::stop_token& stop, accuracy::Estimated* estimate) {
  if (error_seconds_ <= 0.0) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::unique_ptr<accuracy::ErrorMeter> meter,
      accuracy::ErrorMeter::Create(scene, fields_, 0, 0, device_paths::TracersFor(programs_)));
  meter->Show(image);
  meter->Measure(error_seconds_, stop);
  if (const auto error = meter->Result(); error.has_value()) *estimate = error->relative_rmse;
  return absl::OkStatus();
}

absl::StatusOr<TradeRow> Trade::Measure(const Setting& setting, const std::stop_token& stop) {
  if (reference_display_.rgb.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(reference_display_,
                                 Display(frame::TextureOf(comparison_.Reference())));
  }
  scene::Scene scene = scene_;
  scene.rendering.technique = setting.technique;
  TradeRow row;
  row.setting = setting;
  renderers::DrawQuality quality{setting.image_scale, 1.0, setting.light_detail,
                                 setting.single_precision};
  THUNDERHEAD_ASSIGN_OR_RETURN(quality.correction,
                               CorrectionOf(scene, setting.million_paths, stop));
  std::vector<double> milliseconds;
  std::string jpeg;
  // The camera is moved before each frame, so that the view stage runs again. The first frame is
  // not measured because it also compiles shaders and propagates the light.
  for (int i = -1; i < kTimedFrames; ++i) {
    Nudge(&scene.camera);
    const base::Stopwatch stopwatch;
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame linear,
                                 renderer_.Draw(scene, fields_, quality));
    THUNDERHEAD_ASSIGN_OR_RETURN(const frame::RgbImage display, Display(*linear.radiance));
    THUNDERHEAD_ASSIGN_OR_RETURN(jpeg, frame::EncodeJpeg(display.width_px, display.height_px,
                                                         display.rgb, setting.jpeg_quality));
    if (i >= 0) milliseconds.push_back(stopwatch.ElapsedMs());
    if (i + 1 < kTimedFrames) continue;
    const picture::LinearPicture image = frame::PictureOf(*linear.radiance);
    row.relative_rmse = comparison_.RelativeRmseWithoutNoise(image);
    row.relative_bias = comparison_.RelativeBias(image);
    THUNDERHEAD_RETURN_IF_ERROR(Estimate(scene, image, stop, &row.estimated_error));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::RgbImage seen, frame::DecodeJpeg(jpeg));
  row.flip = Flip(seen, reference_display_);
  row.bytes = jpeg.size();
  row.milliseconds = Quantile(milliseconds, 0.5);
  row.milliseconds_spread = Quantile(milliseconds, 0.75) - Quantile(milliseconds, 0.25);
  return row;
}

}  // namespace thunderhead::measure
