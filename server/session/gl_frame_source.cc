#include "session/gl_frame_source.h"

#include <optional>
#include <utility>
#include <vector>

#include "accuracy/corrector_pool.h"
#include "accuracy/estimator.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "renderers/renderer_pool.h"

namespace thunderhead::session {
namespace {

// A cached correction takes less.
constexpr double kMinReported_ms = 0.1;

class GlFrameSource final : public FrameSource {
 public:
  explicit GlFrameSource(std::unique_ptr<gl::Context> context)
      : context_(std::move(context)),
        info_{context_->Info().device, context_->Info().renderer, context_->Info().version} {}

  const DeviceInfo& Device() const override { return info_; }

  std::vector<TechniqueInfo> Techniques() const override { return TechniquesOf(*registry_); }

  std::shared_ptr<Preparation> PreparationOfScenes() const override {
    return registry_->PreparationOfScenes();
  }

  absl::StatusOr<DisplayFrame> Draw(const scene::Scene& scene,
                                    const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                    const FrameQuality& quality) override {
    tone_mapped_.reset();
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
    tone_mapped_.reset();
    const Correction correction = CorrectionOf(scene, fields);
    CheckedFrame checked;
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame coarse,
                                 renderers_.Draw(scene, fields, correction.Applied({1.0, 0.5})));
    const std::vector<float> coarse_radiance = frame::ReadLinear(*coarse.radiance);
    THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame fine,
                                 renderers_.Draw(scene, fields, correction.Applied({})));
    checked.discretisation_error =
        accuracy::DiscretisationError(coarse_radiance, frame::ReadLinear(*fine.radiance));
    THUNDERHEAD_ASSIGN_OR_RETURN(checked.frame, Display(fine, scene, correction));
    return checked;
  }

  absl::StatusOr<accuracy::LightProgress> TraceLight(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      accuracy::LightClaim* claim) override {
    tone_mapped_.reset();
    return correctors_.Trace(scene, fields, claim);
  }

  absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                    const scene::Scene& scene) override {
    tone_mapped_ = std::nullopt;
    picture_ = frame::TextureOf(picture);
    THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                 picture_tone_mapper_.Map(picture_, scene));
    tone_mapped_ = {&picture_, &picture_tone_mapper_};
    DisplayFrame frame;
    Fill(picture.size_px, std::move(mapped), &frame);
    return frame;
  }

  absl::StatusOr<frame::FineImage> Fine() override {
    if (!tone_mapped_.has_value()) {
      return absl::FailedPreconditionError("no picture was drawn that could be had with more bits");
    }
    return tone_mapped_->mapper->MapFine(*tone_mapped_->linear);
  }

 private:
  // The picture drawn last, until anything else is drawn.
  struct Drawn {
    const gl::Texture2D* linear;
    frame::ToneMapper* mapper;
  };

  // The correction of a scene's light by traced paths; null light without any.
  struct Correction {
    std::shared_ptr<const renderers::LightCorrection> light;
    std::int64_t paths = 0;
    double milliseconds = 0.0;  // to compute it

    renderers::DrawQuality Applied(renderers::DrawQuality quality) const {
      quality.correction = light;
      return quality;
    }
  };

  Correction CorrectionOf(const scene::Scene& scene,
                          const std::shared_ptr<const volume::HydrometeorFields>& fields) {
    accuracy::LightCorrector* const corrector = correctors_.Find(scene, fields);
    if (corrector == nullptr) return {};
    const base::Stopwatch stopwatch;
    auto light = corrector->Correction();
    if (light == nullptr) return {};
    return {std::move(light), corrector->Progress().paths, stopwatch.ElapsedMs()};
  }

  absl::StatusOr<DisplayFrame> Display(const renderers::LinearFrame& linear,
                                       const scene::Scene& scene, const Correction& correction) {
    THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                 tone_mapper_.Map(*linear.radiance, scene));
    tone_mapped_ = {linear.radiance, &tone_mapper_};
    DisplayFrame frame;
    frame.stages = linear.stages;
    if (correction.milliseconds >= kMinReported_ms) {
      frame.stages.push_back({scene::FrameStage::kCorrection, correction.milliseconds});
    }
    frame.modelled = {std::string(scene::NameOf(scene.rendering.technique)), linear.content,
                      linear.slices, linear.device_bytes, correction.paths};
    Fill(linear.radiance->Size(), std::move(mapped), &frame);
    return frame;
  }

  static void Fill(const glm::ivec2& size_px, frame::ToneMapped mapped, DisplayFrame* frame) {
    frame->width_px = size_px.x;
    frame->height_px = size_px.y;
    frame->rgb = std::move(mapped.rgb);
    frame->modelled.exposure_ev = mapped.exposure_ev;
    frame->stages.push_back({scene::FrameStage::kTone, mapped.tone_ms});
    frame->stages.push_back({scene::FrameStage::kReadBack, mapped.read_back_ms});
  }

  std::unique_ptr<gl::Context> context_;  // must outlive the GL objects below
  std::shared_ptr<const renderers::TechniqueRegistry> registry_ =
      std::make_shared<renderers::TechniqueRegistry>(renderers::TechniqueRegistry::BuiltIn());
  renderers::RendererPool renderers_{registry_};
  accuracy::CorrectorPool correctors_{renderers_.Programs()};
  frame::ToneMapper tone_mapper_;
  frame::ToneMapper picture_tone_mapper_;  // of Tone, whose pictures have other sizes
  gl::Texture2D picture_;                  // that Tone was given
  std::optional<Drawn> tone_mapped_;
  DeviceInfo info_;
};

}  // namespace

std::vector<TechniqueInfo> TechniquesOf(const renderers::TechniqueRegistry& registry) {
  std::vector<TechniqueInfo> techniques;
  for (const auto& technique : registry.All()) {
    techniques.push_back({std::string(technique->Name()), technique->Capabilities()});
  }
  return techniques;
}

absl::StatusOr<std::unique_ptr<FrameSource>> MakeGlFrameSource(const std::string& device) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<gl::Context> context, gl::Context::Create(device));
  return std::make_unique<GlFrameSource>(std::move(context));
}

}  // namespace thunderhead::session
