// Decides which frame of a session to draw next: coarse while its scene keeps changing, refined
// when the scene is at rest, and finally at full quality. Plain values; the time is an argument.
// Knows no threads and no GL.
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
  double coarse_ms = 33.0;  // for a frame while the scene changes
  // For the coarsest frame with all its pixels. If it takes longer, frames have fewer pixels.
  double whole_size_ms = 45.0;
  double smooth_ms = 10.0;  // cheaper frames get a ray per pixel even then
  // For the first frame at rest: with the delay, encoding and network it is shown within 300 ms.
  double refined_ms = 180.0;
  session::Clock::duration rest_delay = std::chrono::milliseconds(80);
  // The longest that other sessions may wait for the lane that draws a picture. A frame with a
  // longer prediction is drawn after its scene has rested for as long as predicted. The prediction
  // may stem from a moment when the machine was busy.
  double longest_ms = 5000.0;
  // If the full frame of a scene is predicted to take even longer than this, the scene stays at the
  // finest quality that does not.
  double longest_at_rest_ms = 20'000.0;
  // A frame at rest with a longer prediction is drawn in pieces, in a lane.
  double whole_ms = 30.0;
  // A full-quality frame that takes longer than refined_ms delays the next change. So it waits
  // until the scene has very likely come to rest.
  session::Clock::duration settle_delay = std::chrono::milliseconds(500);

  // Return when an unchanged scene is considered to be at rest, and to have settled. Both are later
  // if the changes of its gesture come at larger intervals.
  session::Clock::time_point RestsAt(const session::NewestScene& scene) const {
    return scene.changed_at + std::max(rest_delay, 2 * scene.usual_pause);
  }
  session::Clock::time_point SettlesAt(const session::NewestScene& scene) const {
    return std::max(scene.changed_at + settle_delay, RestsAt(scene));
  }
};

// The smallest image_scale and slice_share of a coarse frame; both vary together up to 1.
inline constexpr double kCoarsest = 0.25;
// The same for sparse frames: below this value the saved rays cost almost nothing, and they are
// needed at edges.
inline constexpr double kCoarsestSparse = 0.353553390593;

// The frame that the source drew last, whose stages it can reuse.
struct LastDrawn {
  scene::Scene scene;
  FrameQuality quality;
  std::weak_ptr<const volume::HydrometeorFields> fields{};
};

// Returns `last_drawn` if it shows these fields, else none. The fields of a time change when its
// file is replaced.
const std::optional<LastDrawn>& IfDrawnFrom(
    const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::optional<LastDrawn>& last_drawn);

// Returns the first stage that drawing `scene` would rerun; the first stage of all if no frame was
// drawn.
scene::Stage FirstDirty(const std::optional<LastDrawn>& last_drawn, const scene::Scene& scene);

struct FramePlan {
  FrameQuality quality;
  bool refined = false;
  // The factor of a coarse frame's output_scale that makes up for a slow machine.
  double speed_scale = 1.0;

  bool operator==(const FramePlan&) const = default;
};

// A frame to draw now, or the time to ask again. Neither is set if there is nothing to draw until
// the scene changes.
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
  // Plans no further frames of that revision because it cannot be drawn, or is not drawn by this
  // planner.
  void GiveUp(std::uint64_t revision);

  // Returns when a finer frame of the last drawn scene comes if it is predicted to take longer than
  // longest_ms. None if there will be none.
  std::optional<session::Clock::time_point> FinerAt(
      const session::NewestScene& drawn, const std::optional<LastDrawn>& last_drawn) const;

  // Returns false if a frame at full quality is predicted to take longer than longest_ms.
  bool DrawsWhole(const scene::Scene& scene) const;

  // Plans the newest revision again, because its setting has changed or a missing resource may be
  // available now. Starts with a coarse frame if the revision was given up before any frame.
  void Again();

  // The newest revision that was drawn or given up.
  std::uint64_t revision() const { return revision_; }

 private:
  FramePlan Coarse(const scene::Scene& scene, const std::optional<LastDrawn>& last_drawn) const;
  // Returns FramePlan::speed_scale of coarse frames of that kind. If the coarsest frame with all
  // its pixels takes longer than whole_size_ms, frames have fewer pixels.
  double SpeedScale(const scene::Scene& scene, const FrameQuality& moving) const;
  Decision AtRest(const session::NewestScene& newest, session::Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;
  // Returns the quality of the first frame at rest. If one ray per pixel takes longer than
  // refined_ms, rays are placed where the picture needs them, because an enlarged smaller picture
  // has rougher edges.
  FrameQuality FinestSoon(const scene::Scene& scene, scene::Stage first_dirty) const;
  FrameQuality Finest(const scene::Scene& scene, scene::Stage first_dirty, double budget_ms,
                      const FrameQuality& moving = {}) const;
  bool IsFiner(const FrameQuality& quality) const;  // than the frame drawn last

  const PlannerTargets targets_;
  const accuracy::MachineCosts& costs_;
  const std::string view_;
  std::uint64_t revision_ = 0;
  std::uint64_t drawn_revision_ = 0;
  bool finished_ = false;  // no finer frame of that revision follows
  FramePlan drawn_;
  double speed_scale_ = 1.0;  // of the last coarse frame
};

}  // namespace thunderhead::drawing
