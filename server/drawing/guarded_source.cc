#include "drawing/guarded_source.h"

#include <utility>

#include "accuracy/moving_picture.h"
#include "base/status.h"
#include "gl/device_faults.h"

namespace thunderhead::drawing {
namespace {

// Bytes per pixel of a picture with 8 bits per channel: 3 for the display pixels, and as many while
// the pixels are encoded.
constexpr std::size_t kBytesPerPixel = 6;
// Bytes per pixel of a picture with 16 bits per channel, with its smaller tiers
// (delivery/link_estimate.h) and while it is encoded.
constexpr std::size_t kFineBytesPerPixel = 16;
// Bytes per pixel of a linear picture, which has radiance, opacity and optical depths.
constexpr std::size_t kLinearBytesPerPixel = 24;

class GuardedSource final : public FrameSource {
 public:
  GuardedSource(std::unique_ptr<FrameSource> source, const SourceGuard& guard,
                std::uint64_t generation)
      : source_(std::move(source)), guard_(guard), generation_(generation) {}

  const DeviceInfo& Device() const override { return source_->Device(); }
  std::vector<scene::TechniqueInfo> Techniques() const override { return source_->Techniques(); }
  std::shared_ptr<Preparation> PreparationOfScenes() const override {
    return source_->PreparationOfScenes();
  }

  absl::StatusOr<DisplayFrame> Draw(const scene::Scene& scene,
                                    const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                    const FrameQuality& quality) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(auto memory,
                                 MemoryOf(accuracy::WithOutputScale(scene, quality.output_scale)));
    auto frame = Noticed(source_->Draw(scene, fields, quality));
    if (frame.ok()) frame->memory = std::move(memory);
    return frame;
  }

  absl::StatusOr<CheckedFrame> DrawChecked(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(auto memory, MemoryOf(scene));
    auto checked = Noticed(source_->DrawChecked(scene, fields));
    if (checked.ok()) checked->frame.memory = std::move(memory);
    return checked;
  }

  absl::StatusOr<accuracy::LightProgress> TraceLight(
      const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
      std::int64_t wanted_paths, accuracy::LightClaim* claim) override {
    return Noticed(source_->TraceLight(scene, fields, wanted_paths, claim));
  }

  absl::StatusOr<accuracy::ErrorProgress> MeasureError(
      const scene::Scene& scene,
      const std::shared_ptr<const volume::HydrometeorFields>& fields) override {
    return Noticed(source_->MeasureError(scene, fields));
  }

  absl::StatusOr<DisplayFrame> Tone(const picture::LinearPicture& picture,
                                    const scene::Scene& scene) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(auto memory, MemoryOf(scene));
    auto frame = Noticed(source_->Tone(picture, scene));
    if (frame.ok()) frame->memory = std::move(memory);
    return frame;
  }

  absl::StatusOr<picture::LinearPicture> Linear() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(linear_memory_, Reserved(kLinearBytesPerPixel));
    return Noticed(source_->Linear());
  }
  absl::StatusOr<frame::FineImage> Fine() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(auto memory, Reserved(kFineBytesPerPixel));
    auto fine = Noticed(source_->Fine());
    if (fine.ok()) fine->memory = std::move(memory);
    return fine;
  }
  void FreeUnused(double unused_s) override { source_->FreeUnused(unused_s); }

 private:
  absl::StatusOr<std::shared_ptr<const base::MemoryReservation>> MemoryOf(
      const scene::Scene& scene) {
    linear_memory_.reset();
    pixels_ = static_cast<std::size_t>(scene.output.width_px) *
              static_cast<std::size_t>(scene.output.height_px);
    return Reserved(kBytesPerPixel);
  }

  // Reserves memory for the picture that was drawn last or is about to be drawn.
  absl::StatusOr<std::shared_ptr<const base::MemoryReservation>> Reserved(
      std::size_t bytes_per_pixel) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        base::MemoryReservation reserved,
        guard_.memory->Reserve(base::MemoryUse::kPictures, pixels_ * bytes_per_pixel, "a picture"));
    return std::make_shared<const base::MemoryReservation>(std::move(reserved));
  }

  template <typename Result>
  Result Noticed(Result result) {
    if (gl::IsDeviceLost(result.status())) guard_.on_device_lost(generation_);
    return result;
  }

  const std::unique_ptr<FrameSource> source_;
  const SourceGuard guard_;
  const std::uint64_t generation_;
  std::size_t pixels_ = 0;
  // Memory of the linear picture, which its caller uses until the next picture is drawn.
  std::shared_ptr<const base::MemoryReservation> linear_memory_;
};

}  // namespace

FrameSourceFactory GuardedSources(FrameSourceFactory make, SourceGuard guard) {
  return [make = std::move(make), guard = std::move(guard)](
             base::DeviceTurn* turn) -> absl::StatusOr<std::unique_ptr<FrameSource>> {
    const std::uint64_t generation = guard.generation;
    THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<FrameSource> source, make(turn));
    return std::make_unique<GuardedSource>(std::move(source), guard, generation);
  };
}

}  // namespace thunderhead::drawing
