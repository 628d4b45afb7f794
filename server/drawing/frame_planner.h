// Decides which frame of a session to draw next. A coarse frame is drawn while its scene keeps
// changing, a refined frame when the scene is at rest, and finally one at full quality. Plain
// values; the time is an argument. This code uses neither threads nor GL.
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
  double coarse_ms = 33.0;  // time limit for a frame while the scene changes
  // Time limit for the coarsest frame in the usual size of a moving picture. If that frame takes
  // longer, moving pictures get a smaller size (speed_scale).
  double whole_size_ms = 45.0;
  // A frame that takes less time than this gets one ray per pixel even while the scene changes. For
  // large pictures (accuracy::MovingOutputScale below 1), coarse_ms applies instead.
  double smooth_ms = 10.0;
  // Time limit for the first frame at rest. Together with rest_delay, encoding and network, the
  // frame is shown within 300 ms.
  double refined_ms = 180.0;
  session::Clock::duration rest_delay = std::chrono::milliseconds(80);
  // The longest that other sessions may wait for the worker that draws a picture. A frame with a
  // longer predicted time is drawn only after its scene has rested for as long as predicted. (The
  // prediction may be too long, because it may stem from a moment when the machine was busy.)
  double longest_ms = 5000.0;
  // If the full-quality frame of a scene is predicted to take longer than this, the scene stays at
  // the finest quality that is predicted to take no longer.
  double longest_at_rest_ms = 20'000.0;
  // A frame at rest whose predicted time is longer than this is drawn in pieces, by a worker.
  double whole_ms = 30.0;
  // The delay before a full-quality frame that takes longer than refined_ms. Such a frame would
  // delay the response to the next change, so it waits until the scene has very likely come to
  // rest.
  session::Clock::duration settle_delay = std::chrono::milliseconds(500);

  // Return the times at which an unchanged scene counts as at rest, and as settled. Both times are
  // later if the changes of its gesture arrive at larger intervals.
  session::Clock::time_point RestsAt(const session::NewestScene& scene) const {
    return scene.changed_at + std::max(rest_delay, 2 * scene.usual_pause);
  }
  session::Clock::time_point SettlesAt(const session::NewestScene& scene) const {
    return std::max(scene.changed_at + settle_delay, RestsAt(scene));
  }
};

// The smallest image_scale and slice_share of a coarse frame. The two have the same value, from
// this minimum up to 1.
inline constexpr double kCoarsest = 0.25;
// The same minimum for sparse frames (frames with rays only where the picture needs them). Below
// this value, leaving out further rays would save almost no time, and these rays are needed at
// edges.
inline constexpr double kCoarsestSparse = 0.353553390593;

// The frame that the source drew last, whose stages it can reuse.
struct LastDrawn {
  scene::Scene scene;
  FrameQuality quality;
  std::weak_ptr<const volume::HydrometeorFields> fields{};
};

// Returns `last_drawn` if it was drawn from `fields`, else none. A storm time gets new fields when
// its file is replaced.
const std::optional<LastDrawn>& IfDrawnFrom(
    const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::optional<LastDrawn>& last_drawn);

// Returns the first stage that must be rerun to draw `scene` after `last_drawn`. Returns the first
// stage of all if no frame was drawn.
scene::Stage FirstDirty(const std::optional<LastDrawn>& last_drawn, const scene::Scene& scene);

struct FramePlan {
  FrameQuality quality;
  bool refined = false;
  // The factor by which a coarse frame's output_scale is reduced on a slow machine.
  double speed_scale = 1.0;

  bool operator==(const FramePlan&) const = default;
};

// A frame to draw now, or the time at which to call Decide again. If neither is set, there is
// nothing to draw until the scene changes.
struct Decision {
  std::optional<FramePlan> plan;
  std::optional<session::Clock::time_point> ask_again_at;
};

class FramePlanner {
 public:
  // `view` is the session's name in `costs`. `costs` must outlive the planner.
  FramePlanner(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
               std::string view);

  Decision Decide(const session::NewestScene& newest, session::Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;

  void Drawn(std::uint64_t revision, const FramePlan& plan);
  // Plans no further frames of that revision, because it cannot be drawn or is drawn by other means
  // (the reference).
  void GiveUp(std::uint64_t revision);

  // Returns when the scene will have rested for as long as the next finer frame is predicted to
  // take, so that this frame is drawn. Returns none if there is no finer frame, or if it is
  // predicted to take longer than longest_at_rest_ms.
  std::optional<session::Clock::time_point> FinerAt(
      const session::NewestScene& drawn, const std::optional<LastDrawn>& last_drawn) const;

  // Returns false if a frame at full quality is predicted to take longer than longest_ms.
  bool DrawsWhole(const scene::Scene& scene) const;

  // Plans the newest revision again, because its setting has changed or a resource that was missing
  // may be available now. Starts with a coarse frame if the revision was given up before any frame
  // was drawn.
  void Again();

  // The newest revision that was drawn or given up.
  std::uint64_t revision() const { return revision_; }

 private:
  FramePlan Coarse(const scene::Scene& scene, const std::optional<LastDrawn>& last_drawn) const;
  // Returns FramePlan::speed_scale for coarse frames of the kind of `moving`. It is below 1 if the
  // coarsest frame in the usual size takes longer than whole_size_ms.
  double SpeedScale(const scene::Scene& scene, const FrameQuality& moving) const;
  Decision AtRest(const session::NewestScene& newest, session::Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;
  // Returns the quality of the first frame at rest. If one ray per pixel takes longer than
  // refined_ms, rays are placed only where the picture needs them. The alternative, an enlarged
  // smaller picture, has rougher edges.
  FrameQuality FinestSoon(const scene::Scene& scene, scene::Stage first_dirty) const;
  FrameQuality Finest(const scene::Scene& scene, scene::Stage first_dirty, double budget_ms,
                      const FrameQuality& moving = {}) const;
  bool IsFiner(const FrameQuality& quality) const;  // compares with the frame drawn last

  const PlannerTargets targets_;
  const accuracy::MachineCosts& costs_;
  const std::string view_;
  std::uint64_t revision_ = 0;
  std::uint64_t drawn_revision_ = 0;
  bool finished_ = false;  // true if no finer frame of drawn_revision_ follows
  FramePlan drawn_;
  double speed_scale_ = 1.0;  // speed_scale of the last coarse frame
};

}  // namespace thunderhead::drawing
