// Decides which frame of a session is due: coarse while its scene keeps changing, refined when it
// rests, always ending at full quality. Plain values; the time is given. Knows no threads and no
// GL.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "accuracy/machine_costs.h"
#include "scene/scene.h"
#include "session/frame_source.h"
#include "session/sessions.h"

namespace thunderhead::session {

struct PlannerTargets {
  double coarse_ms = 33.0;  // a frame while the scene changes
  double refined_ms =
      180.0;  // the first frame at rest; with the delay, encoding and the way within 300 ms
  Clock::duration rest_delay = std::chrono::milliseconds(80);
  // A full-quality frame that takes longer than refined_ms blocks the next change, so it waits
  // until the scene has surely come to rest.
  Clock::duration settle_delay = std::chrono::milliseconds(500);
};

// The coarsest and the finest a frame may be; image_scale and slice_share move together between
// them.
inline constexpr double kCoarsest = 0.25;

// What the frame source drew last, from which it can go on.
struct LastDrawn {
  scene::Scene scene;
  FrameQuality quality;
};

struct FramePlan {
  FrameQuality quality;
  bool refined = false;

  bool operator==(const FramePlan&) const = default;
};

// A frame to draw now, or when to ask again, or neither: nothing until the scene changes.
struct Decision {
  std::optional<FramePlan> plan;
  std::optional<Clock::time_point> ask_again_at;
};

class FramePlanner {
 public:
  // Of the frames of `view`, as it is called in `costs`, which must outlive the planner.
  FramePlanner(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
               std::string view);

  Decision Decide(const NewestScene& newest, Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;

  void Drawn(std::uint64_t revision, const FramePlan& plan);
  // The scene of that revision cannot be drawn, or is shown by other means; it is not tried again.
  void GiveUp(std::uint64_t revision);

  // The scene of the revision drawn last is to be drawn otherwise: it begins anew.
  void Again();

  // The newest revision drawn or given up.
  std::uint64_t revision() const { return revision_; }

 private:
  FramePlan Coarse(const scene::Scene& scene, const std::optional<LastDrawn>& last_drawn) const;
  Decision AtRest(const NewestScene& newest, Clock::time_point now,
                  const std::optional<LastDrawn>& last_drawn) const;
  FrameQuality Finest(const scene::Scene& scene, scene::Stage first_dirty, double budget_ms) const;

  const PlannerTargets targets_;
  const accuracy::MachineCosts& costs_;
  const std::string view_;
  std::uint64_t revision_ = 0;
  bool finished_ = false;  // nothing finer is to come for that revision
  FramePlan drawn_;
};

}  // namespace thunderhead::session
