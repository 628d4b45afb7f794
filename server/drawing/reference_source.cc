#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "drawing/reference_source.h"
#include "reference/scene_tracer.h"
#include "reference/trace_scene.h"

namespace thunderhead::drawing {
namespace {

int DefaultThreads() {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return std::max(cores - std::max(cores / 4, 1), 1);
}

class TracedReferenceSource final : public ReferenceSource {
 public:
  explicit TracedReferenceSource(int threads)
      : tracer_(reference::kPeakCut_deg, {.threads = threads}) {}

  absl::Status Begin(const scene::Scene& scene,
                     const std::shared_ptr<const volume::HydrometeorFields>& fields,
                     const glm::ivec2& size_px) override {
    return tracer_.Begin(scene, fields, size_px);
  }

  delivery::Refinement Refine(int until_samples, double seconds,
                              const std::stop_token& stop) override {
    reference::RefineLimits limits;
    limits.samples_per_pixel = until_samples;
    limits.pause_s = seconds;
    const reference::ImageProgress progress = tracer_.Refine(limits, stop).progress;
    delivery::Refinement refinement;
    refinement.samples_per_pixel = progress.samples_per_pixel;
    if (std::isfinite(progress.relative_error)) {
      refinement.relative_error = progress.relative_error;
    }
    return refinement;
  }

  picture::LinearPicture Snapshot() override {
    picture::LinearPicture picture = tracer_.Snapshot();
    // The standard error is dropped, because sessions show only its mean over the picture
    // (Refinement).
    picture.standard_error = {};
    return picture;
  }

 private:
  reference::SceneTracer tracer_;
};

}  // namespace

std::unique_ptr<ReferenceSource> MakeReferenceSource(int threads) {
  return std::make_unique<TracedReferenceSource>(threads > 0 ? threads : DefaultThreads());
}

}  // namespace thunderhead::drawing
