#include "drawing/reference_schedule.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "glm/common.hpp"

namespace thunderhead::drawing {
namespace {

// The maximum number of pixels of the first size. Tracing them takes a tenth of a second on a slow
// core.
constexpr std::int64_t kFirstPixels = 4096;
// Samples per pixel at each size below the full size. All these sizes together cost a third of the
// time of this number of samples at full size.
constexpr int kSamplesOfSize = 8;
// A picture is shown from this number of samples per pixel on. With a single sample, it would be
// noisier than the smaller picture before it. Only the very first picture is shown with one sample.
constexpr int kMinShownSamples = 2;
constexpr double kShowEvery_s = 1.0;
// The relative error at which refining ends. It is below one level of an 8-bit display.
constexpr double kFinished = 1e-3;
constexpr int kMaxSamples = 1 << 16;

}  // namespace

ReferenceSchedule::ReferenceSchedule(const glm::ivec2& full_size_px) : full_size_px_(full_size_px) {
  const auto pixels = [this] {
    const glm::ivec2 size = SizePx();
    return std::int64_t{size.x} * size.y;
  };
  while (pixels() > kFirstPixels) ++halvings_;
}

glm::ivec2 ReferenceSchedule::SizePx() const {
  const double share = std::exp2(-halvings_);
  return glm::max(glm::ivec2(glm::round(share * glm::dvec2(full_size_px_))), glm::ivec2(1));
}

int ReferenceSchedule::UntilSamples() const {
  const int next_shown = std::max(2 * shown_samples_, any_shown_ ? kMinShownSamples : 1);
  return std::min(next_shown, IsFull() ? kMaxSamples : kSamplesOfSize);
}

bool ReferenceSchedule::ShowNow(const delivery::Refinement& refinement, double shown_ago_s) {
  const int samples = refinement.samples_per_pixel;
  const bool enough = samples >= (any_shown_ ? kMinShownSamples : 1);
  const bool last_of_size = !IsFull() && samples >= kSamplesOfSize;
  const bool due = samples >= 2 * shown_samples_ || last_of_size || shown_ago_s >= kShowEvery_s;
  if (!enough || !due) return false;
  any_shown_ = true;
  shown_samples_ = samples;
  return true;
}

bool ReferenceSchedule::GrowAt(const delivery::Refinement& refinement) {
  if (IsFull() || refinement.samples_per_pixel < kSamplesOfSize) return false;
  --halvings_;
  shown_samples_ = 0;
  return true;
}

bool ReferenceSchedule::Finished(const delivery::Refinement& refinement) const {
  if (!IsFull()) return false;
  const bool exact =
      refinement.samples_per_pixel >= 16 && refinement.relative_error.value_or(1.0) <= kFinished;
  return exact || refinement.samples_per_pixel >= kMaxSamples;
}

}  // namespace thunderhead::drawing
