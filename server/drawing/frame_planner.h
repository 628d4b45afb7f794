// Decides which frame of a session to draw next: coarse while its scene keeps changing, refined
// when it rests, and finally at full quality. Plain values; the time is an argument. Knows no
// threads and no GL.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "accuracy/machine_costs.h"
#include "drawing/frame_source.h"
#include "scene/scene.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

struct PlannerTargets {
  double coarse_ms = 33.0;  // a frame while the scene changes
  // The coarsest frame with all its pixels; where it takes longer, frames have fewer.
  double whole_size_ms = 45.0;
  double smooth_ms = 10.0;  // one that costs no more gets a ray for each pixel even then
  // The first frame at rest: with the delay, encoding and network it is shown within 300 ms.
  double refined_ms = 180.0;
  session::Clock::duration rest_delay = std::chrono::milliseconds(80);
  // Of a session's pictures: how long others may wait for the lane that draws one. A frame that is
  // predicted to take longer is drawn once its scene has rested for as long as that: the estimate
  // may be of a moment at which the machine was busy.
  double longest_ms = 5000.0;
  // A scene whose full frame is predicted to take even longer stays at the finest quality that
  // does not.
  double longest_at_rest_ms = 20'000.0;
  // A frame at rest that is predicted to take longer is drawn in pieces, in a lane.
  double whole_ms = 30.0;
  // A full-quality frame that takes longer than refined_ms blocks the next change, so it waits
  // until the scene has very likely come to rest.
  session::Clock::duration settle_delay = std::chrono::milliseconds(500);

  // When a scene that does not change any more is taken to rest, and to have settled: later where
  // the changes of its gesture come at larger distances.
  session::Clock::time_point RestsAt(const session::NewestScene& scene) const {
    return scene.changed_at + std::max(rest_delay, 2 * scene.usual_pause);
  }
  session::Clock::time_point SettlesAt(const session::NewestScene& scene) const {
    return std::max(scene.changed_at + settle_delay, RestsAt(scene));
  }
};

// The smallest image_scale and slice_share of a coarse frame; both vary together up to 1.
inline constexpr double kCoarsest = 0.25;
// Of sparse frames: the rays that are saved below it cost next to nothing, and are where edges are.
inline constexpr double kCoarsestSparse = 0.353553390593;

// The frame that the source drew last, whose stages it can reuse.
struct LastDrawn {
  scene::Scene scene;
  FrameQuality quality;
  std::weak_ptr<const volume::HydrometeorFields> fields{};
};

// `last_drawn` if it shows these fields: those of a time become others when its file is replaced.
const std::optional<LastDrawn>& IfDrawnFrom(
    const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::optional<LastDrawn>& last_drawn);

// The first stage that drawing `scene` would rerun; all of them after no frame.
scene::Stage FirstDirty(const std::optional<LastDrawn>& last_drawn, const scene::Scene& scene);

struct FramePlan {
  FrameQuality quality;
  bool refined = false;
  // The part of a coarse frame's output_scale that is for this machine's sake.
  double speed_scale = 1.0;

  bool operator==(const FramePlan&) const = default;
};

// A frame to draw now, or when to ask again; neither if there is nothing to draw until the scene
// changes.
struct Decision {
  std::optional<FramePlan> plan;
  std::optional<session::Clock::time_point> ask_again_at;
};

class FramePlanner {
 public:
  // `view` is the name of the session in `costs`, which must outlive the planner.
  FramePlanner(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
               std::string view);

  Decision Decide(const session::NewestScene& newest, session::Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;

  void Drawn(std::uint64_t revision, const FramePlan& plan);
  // Plans no more frames of that revision: it cannot be drawn, or is not drawn by this planner.
  void GiveUp(std::uint64_t revision);

  // When a finer frame of the scene that was drawn last comes, which is predicted to take longer
  // than longest_ms; none if there will be none.
  std::optional<session::Clock::time_point> FinerAt(
      const session::NewestScene& drawn, const std::optional<LastDrawn>& last_drawn) const;

  // False where a frame at full quality is predicted to take longer than longest_ms.
  bool DrawsWhole(const scene::Scene& scene) const;

  // Starts again with the newest revision, as its setting has changed or what it lacked may be
  // there now: coarse, if it was given up before any frame of it.
  void Again();

  // The newest revision drawn or given up.
  std::uint64_t revision() const { return revision_; }

 private:
  FramePlan Coarse(const scene::Scene& scene, const std::optional<LastDrawn>& last_drawn) const;
  // FramePlan::speed_scale of coarse frames of that kind: where the coarsest with all their
  // pixels takes longer than whole_size_ms, they have fewer.
  double SpeedScale(const scene::Scene& scene, const FrameQuality& moving) const;
  Decision AtRest(const session::NewestScene& newest, session::Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;
  // Of the first frame at rest: where a ray for each pixel takes longer than refined_ms, rays go
  // where the picture needs them, as a smaller picture enlarged has the rougher edges.
  FrameQuality FinestSoon(const scene::Scene& scene, scene::Stage first_dirty) const;
  FrameQuality Finest(const scene::Scene& scene, scene::Stage first_dirty, double budget_ms,
                      const FrameQuality& moving = {}) const;
  bool IsFiner(const FrameQuality& quality) const;  // than the frame drawn last

  const PlannerTargets targets_;
  const accuracy::MachineCosts& costs_;
  const std::string view_;
  std::uint64_t revision_ = 0;
  std::uint64_t drawn_revision_ = 0;
  bool finished_ = false;  // no finer frame follows for that revision
  FramePlan drawn_;
  double speed_scale_ = 1.0;  // of the last coarse frame
};

}  // namespace thunderhead::drawing
