// The progress of tracing light for a view at rest, and when to show it. A plain value; the time is
// an argument.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "accuracy/light_progress.h"
#include "session/sessions.h"

namespace thunderhead::session {

// Delay before tracing is tried again when light is traced for too many other scenes.
inline constexpr Clock::duration kTraceAgainAfter = std::chrono::milliseconds(500);

class LightTracing {
 public:
  // Starts again if the revision is a new one.
  void BeginFor(std::uint64_t revision, Clock::time_point now);

  // Records progress. True if the picture should be drawn again with it.
  bool Traced(const accuracy::LightProgress& progress, Clock::time_point now);
  // Records that the picture was drawn with the light traced so far.
  void Shown(Clock::time_point now);

  // Ends tracing for the revision after a step that failed.
  void GiveUp() { ended_ = true; }

  // True if no more light is traced for the revision.
  bool ended() const { return ended_; }

 private:
  std::uint64_t revision_ = 0;
  std::optional<accuracy::LightProgress> begun_at_;  // progress before this view, from earlier ones
  std::int64_t paths_ = 0;
  std::int64_t shown_paths_ = 0;
  Clock::time_point shown_at_;
  bool ended_ = false;
};

}  // namespace thunderhead::session
