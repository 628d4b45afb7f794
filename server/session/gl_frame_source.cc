#include "session/gl_frame_source.h"

#include <cmath>
#include <utility>
#include <vector>

#include "base/status.h"
#include "base/stopwatch.h"
#include "correction/corrector_pool.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "renderers/renderer_pool.h"

namespace thunderhead::session {
namespace {

// Fits metaballs.
class BallPreparation final : public Preparation {
 public:
  explicit BallPreparation(std::shared_ptr<renderers::BallFits> fits) : fits_(std::move(fits)) {}

  bool IsNeeded(const scene::Scene& scene) const override {
    return scene.rendering.renderer == scene::Renderer::kMetaball;
  }

  bool IsDone(const scene::Scene& scene, const Fields& fields) override {
    return !IsNeeded(scene) || fits_->Has(scene, fields);
  }

  absl::Status Prepare(const scene::Scene& scene, const Fields& fields) override {
    if (IsDone(scene, fields)) return absl::OkStatus();
    return fits_->Get(scene, fields).status();
  }

 private:
  std::shared_ptr<renderers::BallFits> fits_;
};

// What took less is one that was there.
constexpr double kWorthSaying_ms = 0.1;

// Relative RMSE of red, green and blue; four values a pixel.
double RelativeDifference(const std::vector<float>& pixels, const std::vector<float>& truth) {
  double squares = 0.0;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i % 4 == 3) continue;
    squares += std::pow(static_cast<double>(pixels[i]) - truth[i], 2);
    sum += truth[i];
    ++count;
  }
  const double values = static_cast<double>(count);
  return sum > 0.0 ? std::sqrt(squares / values) / (sum / values) : 0.0;
}

class GlFrameSource final : public FrameSource {
 public:
  explicit GlFrameSource(std::unique_ptr<gl::Context> context)
      : context_(std::move(context)),
        info_{context_->Info().device, context_->Info().renderer, context_->Info().version} {}

  const DeviceInfo& Device() const override { return info_; }

  std::shared_ptr<Preparation> PreparationOfScenes() const override {
    return std::make_shared<BallPreparation>(fits_);
  }

  absl::StatusOr<DisplayFrame> Draw(const scene::Scene& scene,
                                    const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                    const FrameQuality& quality) override {
    const Correction correction = CorrectionOf(scene, fields);
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const renderers::LinearFrame linear,
        renderers_.Draw(scene, fields,
                        correction.Applied({quality.image_scale, quality.slice_share})));
    return Display(linear, scene, correction);
  }

  absl::StatusOr<CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    const Correction correction = CorrectionOf(scene, fields);
    CheckedFrame checked;
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame coarse,
                                 renderers_.Draw(scene, fields, correction.Applied({1.0, 0.5})));
    const std::vector<float> coarse_radiance = frame::ReadLinear(*coarse.radiance);
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame fine,
                                 renderers_.Draw(scene, fields, correction.Applied({})));
    checked.discretisation_error =
        RelativeDifference(coarse_radiance, frame::ReadLinear(*fine.radiance));
    THUNDERHEAD_ASSIGN_OR_RETURN(checked.frame, Display(fine, scene, correction));
    return checked;
  }

  absl::StatusOr<correction::LightProgress> TraceLight(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    return correctors_.Trace(scene, fields);
  }

  absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                    const scene::Display& display) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                 picture_tone_mapper_.Map(frame::TextureOf(picture), display));
    DisplayFrame frame;
    Fill(picture.size_px, std::move(mapped), &frame);
    return frame;
  }

 private:
  // What traced paths correct of a scene's light; without any, nothing.
  struct Correction {
    std::shared_ptr<const renderers::LightCorrection> light;
    std::int64_t paths = 0;
    double milliseconds = 0.0;  // that finding it took

    renderers::DrawQuality Applied(renderers::DrawQuality quality) const {
      quality.correction = light;
      return quality;
    }
  };

  Correction CorrectionOf(const scene::Scene& scene,
                          const std::shared_ptr<const volume::HydrometeorFields>& fields) {
    correction::LightCorrector* const corrector = correctors_.Find(scene, fields);
    if (corrector == nullptr) return {};
    const base::Stopwatch stopwatch;
    auto light = corrector->Correction();
    return {std::move(light), corrector->Progress().paths, stopwatch.ElapsedMs()};
  }

  absl::StatusOr<DisplayFrame> Display(const renderers::LinearFrame& linear,
                                       const scene::Scene& scene, const Correction& correction) {
    THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                 tone_mapper_.Map(*linear.radiance, scene.display));
    DisplayFrame frame;
    for (const renderers::StageTime& stage : linear.stages) {
      frame.stages.push_back({stage.stage, stage.milliseconds});
    }
    if (correction.milliseconds >= kWorthSaying_ms) {
      frame.stages.push_back({"correction", correction.milliseconds});
    }
    Fill(linear.radiance->Size(), std::move(mapped), &frame);
    frame.modelled = {linear.fields,
                      linear.slices,
                      linear.device_bytes,
                      linear.occupied_share,
                      scene.rendering.renderer,
                      linear.balls,
                      linear.fit_error,
                      linear.not_shown,
                      linear.ellipsoids,
                      correction.paths};
    return frame;
  }

  static void Fill(const glm::ivec2& size_px, frame::ToneMapped mapped, DisplayFrame* frame) {
    frame->width_px = size_px.x;
    frame->height_px = size_px.y;
    frame->rgb = std::move(mapped.rgb);
    frame->stages.push_back({"tone", mapped.tone_ms});
    frame->stages.push_back({"read_back", mapped.read_back_ms});
  }

  std::unique_ptr<gl::Context> context_;  // outlives what was made in it
  std::shared_ptr<renderers::BallFits> fits_ = std::make_shared<renderers::BallFits>();
  renderers::RendererPool renderers_{fits_};
  correction::CorrectorPool correctors_;
  frame::ToneMapper tone_mapper_;
  frame::ToneMapper picture_tone_mapper_;  // of other sizes: each keeps its buffers
  DeviceInfo info_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<FrameSource>> MakeGlFrameSource(const std::string& device) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<gl::Context> context, gl::Context::Create(device));
  return std::make_unique<GlFrameSource>(std::move(context));
}

}  // namespace thunderhead::session
