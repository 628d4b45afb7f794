#include "accuracy/error_meters.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "reference/scene_problem.h"
#include "scene/scene_parts.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {
namespace {

// The picture is drawn again when the number of paths that correct its light has grown by this
// factor.
constexpr double kRedrawnGrowth = 1.3;

// A measurement ends when the width of the confidence interval is at most kEnoughWidth times the
// error, or after kMaxTraced_s seconds of tracing.
constexpr double kEnoughWidth = 0.25;
constexpr double kMaxTraced_s = 30.0;

// If the ground's heights differ by less than this, the ground counts as level.
constexpr float kLevel_m = 1.0F;

bool IsEnough(const Estimated& error) {
  return error.high - error.low <= kEnoughWidth * error.value;
}

}  // namespace

scene::Scene MeasuredScene(const scene::Scene& scene) {
  scene::Scene measured = scene;
  measured.ground = {.cover = scene.ground.cover};
  if (auto* medium = scene::MediumSettingsOf(&measured.rendering.technique); medium != nullptr) {
    medium->look.detail = false;
  }
  return measured;
}

bool IsMeasurable(const volume::HydrometeorFields& fields) {
  if (fields.terrain_height_m.empty()) return true;
  const auto [low, high] = std::ranges::minmax(fields.terrain_height_m);
  return high - low < kLevel_m;
}

void ErrorMeters::DropUnused() {
  std::erase_if(kept_,
                [this](const Kept& kept) { return kept.since_used.ElapsedMs() > 1e3 * unused_s_; });
}

bool ErrorMeters::DropOldest() {
  const auto oldest = std::ranges::max_element(
      kept_, {}, [](const Kept& kept) { return kept.since_used.ElapsedMs(); });
  if (oldest == kept_.end() || oldest->since_used.ElapsedMs() < 1e3 * busy_s_) return false;
  kept_.erase(oldest);
  return true;
}

absl::StatusOr<ErrorMeters::Kept*> ErrorMeters::For(const scene::Scene& measured,
                                                    const Fields& fields) {
  const auto found = std::ranges::find_if(kept_, [&](const Kept& kept) {
    return kept.fields == fields &&
           scene::Agree(kept.scene, measured, &scene::ScenePart::measured_error);
  });
  if (found != kept_.end()) return &*found;
  if (kept_.size() >= max_meters_ && !DropOldest()) {
    return absl::ResourceExhaustedError(absl::StrCat("the server measures the error of ",
                                                     kept_.size(),
                                                     " other scenes already; try again later"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(
      base::MemoryReservation reserved,
      memory_->Reserve(base::MemoryUse::kTracing, reference::MediumBytes(*fields, true),
                       "measuring a picture's error", base::MemoryBudget::Urgency::kAhead));
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<ErrorMeter> meter,
                               ErrorMeter::Create(measured, fields, 0, 0, makes_tracer_));
  Kept& kept = kept_.emplace_back();
  kept.scene = measured;
  kept.fields = fields;
  kept.reserved = std::move(reserved);
  kept.meter = std::move(meter);
  return &kept;
}

absl::StatusOr<ErrorProgress> ErrorMeters::Step(const scene::Scene& scene, const Fields& fields,
                                                std::int64_t light_paths, const Draw& draw,
                                                const reference::IsWanted& wanted) {
  DropUnused();
  if (!IsMeasurable(*fields)) return ErrorProgress{.ended = true};
  const scene::Scene measured = MeasuredScene(scene);
  THUNDERHEAD_ASSIGN_OR_RETURN(Kept* const kept, For(measured, fields));
  kept->since_used.Restart();
  const auto progress = [&] {
    ErrorProgress so_far{.error = kept->meter->Result(), .traced_s = kept->meter->TracedSeconds()};
    so_far.ended = !kept->meter->IsMeasurable() || so_far.traced_s >= kMaxTraced_s ||
                   (so_far.error.has_value() && IsEnough(so_far.error->relative_rmse));
    return so_far;
  };
  const bool outdated =
      !kept->drawn_paths.has_value() || (*kept->drawn_paths == 0 && light_paths > 0) ||
      static_cast<double>(light_paths) > kRedrawnGrowth * static_cast<double>(*kept->drawn_paths);
  if (outdated) {
    THUNDERHEAD_ASSIGN_OR_RETURN(picture::LinearPicture picture, draw(measured));
    kept->meter->Show(std::move(picture));
    kept->drawn_paths = light_paths;
  } else if (!progress().ended) {
    THUNDERHEAD_RETURN_IF_ERROR(kept->meter->Step(wanted));
  }
  kept->since_used.Restart();
  return progress();
}

}  // namespace thunderhead::accuracy
