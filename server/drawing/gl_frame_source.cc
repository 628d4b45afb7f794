#include "drawing/gl_frame_source.h"

#include <optional>
#include <utility>
#include <vector>

#include "accuracy/corrector_pool.h"
#include "accuracy/error_meters.h"
#include "accuracy/estimator.h"
#include "accuracy/moving_picture.h"
#include "accuracy/traced_lights.h"
#include "base/guarded.h"
#include "base/status.h"
#include "device_paths/device_tracer.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "gl/device.h"
#include "gl/device_memory.h"
#include "renderers/renderer_pool.h"

namespace thunderhead::drawing {
namespace {

// The state that all sources of one device share.
struct Shared {
  std::shared_ptr<const renderers::TechniqueRegistry> registry =
      std::make_shared<renderers::TechniqueRegistry>(renderers::TechniqueRegistry::BuiltIn());
  std::shared_ptr<accuracy::TracedLights> lights = std::make_shared<accuracy::TracedLights>();
  GlSourceOptions options;
};

std::shared_ptr<base::MemoryBudget> OrUnlimited(const std::shared_ptr<base::MemoryBudget>& budget) {
  return budget != nullptr ? budget : base::MemoryBudget::Unlimited();
}

// Returns the budget for the GL objects in the context of the calling thread.
std::shared_ptr<base::MemoryBudget> BudgetOf(const GlSourceOptions& options) {
  return OrUnlimited(gl::DrawsInSoftware() ? options.memory : options.gpu_memory);
}

class GlFrameSource final : public FrameSource {
 public:
  GlFrameSource(std::unique_ptr<gl::Context> context, Shared shared, base::DeviceTurn* turn)
      : context_(std::move(context)),
        shared_(std::move(shared)),
        watch_(shared_.options.watch_device()),
        memory_(BudgetOf(shared_.options), [this] { return DropOldest(); }),
        programs_(std::make_shared<gl::ProgramCache>(turn)),
        info_{context_->Info().device, context_->Info().renderer, context_->Info().version} {}

  const DeviceInfo& Device() const override { return info_; }

  std::vector<scene::TechniqueInfo> Techniques() const override {
    return shared_.registry->Infos();
  }

  std::shared_ptr<Preparation> PreparationOfScenes() const override {
    return shared_.registry->PreparationOfScenes();
  }

  absl::StatusOr<DisplayFrame> Draw(const scene::Scene& whole,
                                    const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                    const FrameQuality& quality) override {
    return Watched([&]() -> absl::StatusOr<DisplayFrame> {
      const scene::Scene scene = accuracy::WithOutputScale(whole, quality.output_scale);
      const Correction correction = CorrectionOf(scene, fields);
      if (quality.sparse) return DrawMoving(scene, fields, quality, correction);
      renderers::DrawQuality drawn{quality.image_scale, quality.slice_share};
      drawn.quick_water_paths = quality.image_scale < 1.0;
      THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame linear,
                                   renderers_.Draw(scene, fields, Applied(correction, drawn)));
      return Display(linear, scene, correction);
    });
  }

  absl::StatusOr<CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    return Watched([&]() -> absl::StatusOr<CheckedFrame> {
      const Correction correction = CorrectionOf(scene, fields);
      CheckedFrame checked;
      THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame coarse,
                                   renderers_.Draw(scene, fields, Applied(correction, {1.0, 0.5})));
      gl::Pieces& pieces = programs_->Pieces();
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> coarse_radiance,
                                   frame::ReadLinear(*coarse.radiance, pieces));
      THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame fine,
                                   renderers_.Draw(scene, fields, Applied(correction, {})));
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> fine_radiance,
                                   frame::ReadLinear(*fine.radiance, pieces));
      THUNDERHEAD_RETURN_IF_ERROR(pieces.OffTurn([&] {
        checked.discretisation_error =
            accuracy::DiscretisationError(coarse_radiance, fine_radiance);
      }));
      THUNDERHEAD_ASSIGN_OR_RETURN(checked.frame, Display(fine, scene, correction));
      return checked;
    });
  }

  absl::StatusOr<accuracy::LightProgress> TraceLight(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      std::int64_t wanted_paths, accuracy::LightClaim* claim) override {
    ForgetDrawn();
    auto progress =
        base::Guarded([&] { return correctors_.Trace(scene, fields, claim, wanted_paths); });
    if (absl::Status fault = Look(); !fault.ok()) return fault;
    return progress;
  }

  absl::StatusOr<accuracy::ErrorProgress> MeasureError(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    // If memory is scarce, no error is measured, because pictures need the memory more. The error
    // from the accuracy table is then still reported.
    if (!HasRoomToMeasure(scene, *fields)) return accuracy::ErrorProgress{.ended = true};
    const Correction correction = CorrectionOf(scene, fields);
    auto progress = base::Guarded([&] {
      const auto draw = [&](const scene::Scene& measured) {
        return Watched([&]() -> absl::StatusOr<picture::LinearPicture> {
          THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame linear,
                                       renderers_.Draw(measured, fields, Applied(correction, {})));
          auto picture = frame::PictureOf(*linear.radiance, programs_->Pieces());
          // If memory is scarce, unused renderers are freed. Tracing needs their memory, because it
          // draws the storm with a separate renderer.
          if (!HasRoomToMeasure(scene, *fields)) renderers_.DropUnusedFor(0.0);
          return picture;
        });
      };
      return meters_.Step(scene, fields, correction.paths, draw,
                          [this] { return programs_->Pieces().Wanted(); });
    });
    if (absl::Status fault = Look(); !fault.ok()) return fault;
    return progress;
  }

  absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                    const scene::Scene& scene) override {
    return Watched([&]() -> absl::StatusOr<DisplayFrame> {
      picture_ = frame::TextureOf(picture);
      THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                   picture_tone_mapper_.Map(picture_, scene));
      tone_mapped_ = {&picture_, &picture_tone_mapper_};
      DisplayFrame frame;
      Fill(picture.size_px, std::move(mapped), &frame);
      return frame;
    });
  }

  absl::StatusOr<frame::FineImage> Fine() override {
    if (completed_.has_value()) return *std::exchange(completed_, std::nullopt);
    if (!tone_mapped_.has_value()) {
      return absl::FailedPreconditionError(
          "there is no rendered frame to read with more than 8 bits");
    }
    return programs_->Pieces().During(
        [&] { return tone_mapped_->mapper->MapFine(*tone_mapped_->linear); });
  }

  void FreeUnused(double unused_s) override {
    ForgetDrawn();
    renderers_.DropUnusedFor(unused_s);
    while (correctors_.DropOldest() || meters_.DropOldest()) {
    }
  }

  absl::StatusOr<picture::LinearPicture> Linear() override {
    if (!tone_mapped_.has_value()) {
      return absl::FailedPreconditionError("there is no rendered frame to read radiance from");
    }
    return programs_->Pieces().During([&]() -> absl::StatusOr<picture::LinearPicture> {
      return frame::PictureOf(*tone_mapped_->linear, programs_->Pieces());
    });
  }

 private:
  absl::StatusOr<DisplayFrame> DrawMoving(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      const FrameQuality& quality, const accuracy::TracedLights::Found& correction) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const renderers::LinearFrame linear,
        renderers_.Draw(scene, fields,
                        Applied(correction, accuracy::MovingQuality(scene, quality))));
    if (!linear.coarse) return Display(linear, scene, correction);
    DisplayFrame frame = Described(linear, scene, correction);
    THUNDERHEAD_ASSIGN_OR_RETURN(
        accuracy::CompletedPicture whole,
        accuracy::CompleteMoving(
            linear, scene, quality, tone_mapper_,
            [this](const std::vector<glm::vec2>& places) { return renderers_.DrawChosen(places); },
            &frame.stages));
    Fill({scene.output.width_px, scene.output.height_px}, std::move(whole.mapped), &frame);
    completed_ = std::move(whole.fine);
    return frame;
  }

  // The picture that was drawn last; absent once anything else is drawn.
  struct Drawn {
    const gl::Texture2D* linear;
    frame::ToneMapper* mapper;
  };

  void ForgetDrawn() {
    tone_mapped_.reset();
    completed_.reset();
  }

  // Returns the fault that the device has had since the last check; OK if there was none.
  absl::Status Look() { return gl::StatusOf(watch_->Look()); }

  // Returns true if half of the budget would still be free after adding the storm, its light and a
  // picture of the scene's size. Errors are measured only when memory is plentiful.
  bool HasRoomToMeasure(const scene::Scene& scene, const volume::HydrometeorFields& fields) const {
    constexpr std::size_t kBytesPerPixel = 64;
    constexpr std::size_t kBytesPerCell = 160;  // for five fields: 154 bytes, rounded up
    const auto pixels = static_cast<std::size_t>(scene.output.width_px) *
                        static_cast<std::size_t>(scene.output.height_px);
    return BudgetOf(shared_.options)
        ->HasRoom(kBytesPerPixel * pixels + kBytesPerCell * fields.grid.CellCount(), 0.5);
  }

  bool DropOldest() {
    return renderers_.DropOldest() || meters_.DropOldest() || correctors_.DropOldest();
  }

  // Returns the result of `draw`, or the device's fault. If memory is exhausted, frees everything
  // that is kept for other pictures, because a renderer without all its memory is useless. If the
  // device itself was out of memory, then tries once more.
  template <typename Draw>
  auto Watched(const Draw& draw) -> decltype(draw()) {
    ForgetDrawn();
    for (bool again = false;; again = true) {
      auto drawn = base::Guarded([&] { return programs_->Pieces().During(draw); });
      if (absl::Status fault = Look(); !fault.ok()) drawn = std::move(fault);
      if (!absl::IsResourceExhausted(drawn.status())) return drawn;
      FreeUnused(0.0);
      if (again || !gl::IsOutOfDeviceMemory(drawn.status())) return drawn;
    }
  }

  // The path-traced correction of a scene's light; null if no paths were traced.
  using Correction = accuracy::TracedLights::Found;

  static renderers::DrawQuality Applied(const Correction& correction,
                                        renderers::DrawQuality quality) {
    quality.correction = correction.correction;
    return quality;
  }

  Correction CorrectionOf(const scene::Scene& scene,
                          const std::shared_ptr<const volume::HydrometeorFields>& fields) {
    return shared_.lights->Find(scene, fields).value_or(Correction{});
  }

  absl::StatusOr<DisplayFrame> Display(const renderers::LinearFrame& linear,
                                       const scene::Scene& scene, const Correction& correction) {
    THUNDERHEAD_ASSIGN_OR_RETURN(frame::ToneMapped mapped,
                                 tone_mapper_.Map(*linear.radiance, scene));
    tone_mapped_ = {linear.radiance, &tone_mapper_};
    DisplayFrame frame = Described(linear, scene, correction);
    Fill(linear.radiance->Size(), std::move(mapped), &frame);
    return frame;
  }

  static DisplayFrame Described(const renderers::LinearFrame& linear, const scene::Scene& scene,
                                const Correction& correction) {
    DisplayFrame frame;
    frame.stages = linear.stages;
    frame.modelled = {std::string(scene::NameOf(scene.rendering.technique)), linear.content,
                      linear.slices, linear.device_bytes, correction.paths};
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
  const Shared shared_;
  const std::unique_ptr<gl::DeviceWatch> watch_;
  const gl::DeviceMemory memory_;  // counts the memory of the GL objects below
  std::shared_ptr<gl::ProgramCache> programs_;
  renderers::RendererPool renderers_{shared_.registry, programs_};
  accuracy::CorrectorPool correctors_{programs_, shared_.lights,
                                      OrUnlimited(shared_.options.memory)};
  // At most two meters at a time, because each holds its storm's fields and a copy of their
  // extinction.
  accuracy::ErrorMeters meters_{OrUnlimited(shared_.options.memory), 2, 3.0, 5.0,
                                device_paths::TracersFor(programs_)};
  frame::ToneMapper tone_mapper_{programs_};
  frame::ToneMapper picture_tone_mapper_{programs_};  // for Tone, whose pictures have other sizes
  gl::Texture2D picture_;                             // last picture given to Tone
  std::optional<Drawn> tone_mapped_;
  std::optional<frame::FineImage> completed_;  // picture completed from a sparse one
  DeviceInfo info_;
};

}  // namespace

FrameSourceFactory GlFrameSources(const std::string& device, GlSourceOptions options) {
  return [device, shared = Shared{.options = std::move(options)}](base::DeviceTurn* turn) {
    return base::Guarded([&]() -> absl::StatusOr<std::unique_ptr<FrameSource>> {
      THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<gl::Context> context,
                                   gl::Context::Create(device));
      return std::make_unique<GlFrameSource>(std::move(context), shared, turn);
    });
  };
}

}  // namespace thunderhead::drawing
