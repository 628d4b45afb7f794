#include "drawing/frame_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "accuracy/moving_picture.h"

namespace thunderhead::drawing {
namespace {

// The number of quality steps between the coarsest and the full quality, in equal ratios. Because
// of the steps, a slightly changed prediction does not change the buffers' size.
constexpr int kSteps = 8;

// Returns `quality` with image scale and slice share of that step.
FrameQuality Step(int step, FrameQuality quality) {
  const double coarsest = quality.sparse ? kCoarsestSparse : kCoarsest;
  const double share = std::pow(coarsest, 1.0 - static_cast<double>(step) / kSteps);
  quality.image_scale = step == kSteps ? 1.0 : share;
  quality.slice_share = quality.image_scale;
  return quality;
}

// Limits on making pictures smaller for speed. Below kLeastPixels, fewer pixels hardly reduce the
// cost of a frame.
constexpr double kLeastOutputScale = 0.5;
constexpr double kLeastPixels = 640.0 * 360.0;
// During a gesture, the output scale changes only if the required scale differs by more than this
// factor. People see each change of size, and each costs a video key frame.
constexpr double kKept = 1.15;
constexpr double kStep = 1.189207115;  // 2^(1/4)

// Rounds the scale down to a step: at most 1, and at least the minimum for a picture of that many
// pixels.
double OutputStep(double scale, double pixels) {
  constexpr double kRounding = 1e-6;
  const double least = std::clamp(std::sqrt(kLeastPixels / pixels), kLeastOutputScale, 1.0);
  if (scale >= 1.0) return 1.0;
  const double steps = std::floor(std::log(scale) / std::log(kStep) + kRounding);
  return std::max(std::pow(kStep, steps), least);
}

bool IsFull(const FrameQuality& quality) { return quality == FrameQuality{}; }

// Returns the first stage to rerun for a frame at rest, which is drawn again even if the last frame
// shows the same scene.
scene::Stage FirstDirtyAtRest(const std::optional<LastDrawn>& last_drawn,
                              const scene::Scene& scene) {
  return std::min(FirstDirty(last_drawn, scene), scene::Stage::kView);
}

}  // namespace

const std::optional<LastDrawn>& IfDrawnFrom(
    const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::optional<LastDrawn>& last_drawn) {
  static const std::optional<LastDrawn> kNone;
  return last_drawn.has_value() && last_drawn->fields.lock() == fields ? last_drawn : kNone;
}

scene::Stage FirstDirty(const std::optional<LastDrawn>& last_drawn, const scene::Scene& scene) {
  if (!last_drawn.has_value()) return scene::Stage::kStorm;
  return scene::FirstDirtyStage(last_drawn->scene, scene);
}

FramePlanner::FramePlanner(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
                           std::string view)
    : targets_(targets), costs_(costs), view_(std::move(view)) {}

Decision FramePlanner::Decide(const session::NewestScene& newest, session::Clock::time_point now,
                              const std::optional<LastDrawn>& last_drawn) const {
  if (newest.revision > revision_) return {Coarse(*newest.scene, last_drawn), std::nullopt};
  if (finished_) return {};
  return AtRest(newest, now, last_drawn);
}

FramePlan FramePlanner::Coarse(const scene::Scene& scene,
                               const std::optional<LastDrawn>& last_drawn) const {
  scene::Stage first_dirty = FirstDirty(last_drawn, scene);
  // A sparse picture's rays are not kept, so a changed tone map redraws the picture. Redrawing it
  // in the quality that it had at rest would take too long, so a coarse picture is drawn.
  if (last_drawn.has_value() && last_drawn->quality.sparse && drawn_.refined) {
    first_dirty = std::min(first_dirty, scene::Stage::kView);
  }
  if (first_dirty < scene::Stage::kTone) {
    const double whole_ms = costs_.FrameMs(view_, scene, FrameQuality{}, first_dirty);
    const double output_scale = accuracy::MovingOutputScale(scene);
    const bool large = output_scale < 1.0;
    FrameQuality moving;
    double speed_scale = 1.0;
    // If the last frame of the gesture was reduced in size, the full size returns only if frames
    // are clearly fast enough, because viewers see each change of size.
    const bool capped = !drawn_.refined && drawn_.quality.output_scale < 1.0;
    const double longest_ms = large ? targets_.coarse_ms : targets_.smooth_ms;
    if (whole_ms > (capped ? longest_ms / kKept : longest_ms)) {
      moving.sparse = accuracy::MovesSparsely(scene);
      speed_scale = SpeedScale(scene, moving);
      moving.output_scale = output_scale * speed_scale;
    }
    const FrameQuality quality = Finest(scene, first_dirty, targets_.coarse_ms, moving);
    return {quality, IsFull(quality), speed_scale};
  }
  // If only the tone map changes, the linear frame is reused with its quality, at no cost.
  const bool as_refined_as_before = drawn_.refined && drawn_.quality == last_drawn->quality;
  return {last_drawn->quality, IsFull(last_drawn->quality) || as_refined_as_before, speed_scale_};
}

double FramePlanner::SpeedScale(const scene::Scene& scene, const FrameQuality& moving) const {
  FrameQuality coarsest = Step(0, moving);
  const double most = accuracy::MovingOutputScale(scene);
  const double pixels = most * most * scene.output.width_px * scene.output.height_px;
  coarsest.output_scale = most * speed_scale_;
  const double ms = costs_.FrameMs(view_, scene, coarsest, scene::Stage::kView);
  const double wanted = speed_scale_ * std::sqrt(targets_.whole_size_ms / ms);
  const bool gesture_begins = drawn_.refined;
  if (gesture_begins || wanted <= speed_scale_ / kKept) return OutputStep(wanted, pixels);
  // The scale grows one step at a time because one fast frame may be a coincidence.
  return wanted >= speed_scale_ * kKept ? OutputStep(kStep * speed_scale_, pixels) : speed_scale_;
}

Decision FramePlanner::AtRest(const session::NewestScene& newest, session::Clock::time_point now,
                              const std::optional<LastDrawn>& last_drawn) const {
  const session::Clock::time_point rested_at = targets_.RestsAt(newest);
  if (now < rested_at) return {std::nullopt, rested_at};
  const scene::Stage first_dirty = FirstDirtyAtRest(last_drawn, *newest.scene);
  if (!drawn_.refined) {
    const FrameQuality quality = FinestSoon(*newest.scene, first_dirty);
    if (IsFiner(quality)) return {FramePlan{quality, true}, std::nullopt};
  }
  const session::Clock::time_point settled_at = targets_.SettlesAt(newest);
  if (now < settled_at) return {std::nullopt, settled_at};
  const std::chrono::duration<double, std::milli> rested = now - newest.changed_at;
  const double budget_ms =
      std::clamp(rested.count(), targets_.longest_ms, targets_.longest_at_rest_ms);
  const FrameQuality finest = Finest(*newest.scene, first_dirty, budget_ms);
  // If no refined frame was drawn yet, a frame is drawn even if it is no finer than the last. The
  // prediction may stem from a moment when the machine was busy.
  if (!IsFiner(finest) && drawn_.refined) return {};
  return {FramePlan{finest, true}, std::nullopt};
}

std::optional<session::Clock::time_point> FramePlanner::FinerAt(
    const session::NewestScene& drawn, const std::optional<LastDrawn>& last_drawn) const {
  if (finished_) return std::nullopt;
  const scene::Stage first_dirty = FirstDirtyAtRest(last_drawn, *drawn.scene);
  for (int step = 0; step <= kSteps; ++step) {
    const FrameQuality quality = Step(step, {});
    if (!IsFiner(quality)) continue;
    const double ms = costs_.FrameMs(view_, *drawn.scene, quality, first_dirty);
    if (ms > targets_.longest_at_rest_ms) return std::nullopt;
    return drawn.changed_at + std::chrono::milliseconds(1 + std::llround(ms));
  }
  return std::nullopt;
}

bool FramePlanner::DrawsWhole(const scene::Scene& scene) const {
  return costs_.FrameMs(view_, scene, FrameQuality{}, scene::Stage::kView) <= targets_.longest_ms;
}

void FramePlanner::Drawn(std::uint64_t revision, const FramePlan& plan) {
  revision_ = revision;
  drawn_revision_ = revision;
  finished_ = IsFull(plan.quality);
  drawn_ = plan;
  if (!plan.refined) speed_scale_ = plan.speed_scale;
}

void FramePlanner::GiveUp(std::uint64_t revision) {
  revision_ = std::max(revision_, revision);
  finished_ = true;
}

void FramePlanner::Again() {
  revision_ = drawn_revision_;
  finished_ = false;
  drawn_ = {FrameQuality{0.0, 0.0}, false};
}

bool FramePlanner::IsFiner(const FrameQuality& quality) const {
  return IsFull(quality) || quality.Scale() > drawn_.quality.Scale();
}

FrameQuality FramePlanner::FinestSoon(const scene::Scene& scene, scene::Stage first_dirty) const {
  const FrameQuality rayed = Finest(scene, first_dirty, targets_.refined_ms);
  // Large pictures (whose output scale is below 1 while they move) are not drawn sparsely at rest,
  // because the work per pixel on the CPU takes too long.
  const bool sparse = accuracy::MovesSparsely(scene) && accuracy::MovingOutputScale(scene) >= 1.0;
  if (IsFull(rayed) || !sparse) return rayed;
  const FrameQuality fewer = Finest(scene, first_dirty, targets_.refined_ms, {.sparse = true});
  // A frame at scale 1 would count as a full-quality frame, so that no finer frame would follow.
  return fewer.image_scale < 1.0 ? fewer : Step(kSteps - 1, fewer);
}

FrameQuality FramePlanner::Finest(const scene::Scene& scene, scene::Stage first_dirty,
                                  double budget_ms, const FrameQuality& moving) const {
  for (int step = kSteps; step > 0; --step) {
    const FrameQuality quality = Step(step, moving);
    if (costs_.FrameMs(view_, scene, quality, first_dirty) <= budget_ms) return quality;
  }
  return Step(0, moving);
}

}  // namespace thunderhead::drawing
