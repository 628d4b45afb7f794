#include "drawing/light_tracing.h"

#include "accuracy/setting.h"

namespace thunderhead::drawing {
namespace {

// The picture is drawn again when the number of traced paths has grown by this factor. The last
// drawing must be at least kMinBetween ago. After kMaxBetween, the picture is drawn in any case.
constexpr double kShownGrowth = 1.5;
constexpr session::Clock::duration kMinBetween = std::chrono::milliseconds(500);
constexpr session::Clock::duration kMaxBetween = std::chrono::seconds(5);

}  // namespace

void LightTracing::BeginFor(std::uint64_t revision, session::Clock::time_point now) {
  if (revision_ == revision) return;
  *this = LightTracing();
  revision_ = revision;
  shown_at_ = now;
}

bool LightTracing::Traced(const accuracy::LightProgress& progress, session::Clock::time_point now) {
  paths_ = progress.paths;
  if (!begun_at_.has_value()) {
    begun_at_ = progress;
    shown_paths_ = paths_;
  }
  const accuracy::LightProgress since{paths_ - begun_at_->paths, progress.steps - begun_at_->steps};
  ended_ = progress.steps == 0 || since.HasTraced(accuracy::kTracedPaths);
  if (!progress.Corrects()) return false;
  const session::Clock::duration since_shown = now - shown_at_;
  const bool more = static_cast<double>(paths_) >= kShownGrowth * static_cast<double>(shown_paths_);
  due_ = ended_ || since_shown >= kMaxBetween || (more && since_shown >= kMinBetween);
  return due_;
}

void LightTracing::Shown(session::Clock::time_point now) {
  shown_paths_ = paths_;
  shown_at_ = now;
  due_ = false;
}

}  // namespace thunderhead::drawing
