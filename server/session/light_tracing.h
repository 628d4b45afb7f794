// How far the light of a view at rest has been traced, and when that is worth showing. A plain
// value; the time is given.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "accuracy/light_progress.h"
#include "session/sessions.h"

namespace thunderhead::session {

// When tracing is tried again for what found too much of it going on.
inline constexpr Clock::duration kTraceAgainAfter = std::chrono::milliseconds(500);

class LightTracing {
 public:
  // Begins anew if it was another revision's.
  void BeginFor(std::uint64_t revision, Clock::time_point now);

  // Tracing has come so far. True if that is to be shown.
  bool Traced(const accuracy::LightProgress& progress, Clock::time_point now);
  // It has been, at `now`.
  void Shown(Clock::time_point now);

  // A step failed: no more is traced for the revision.
  void GiveUp() { ended_ = true; }

  // Nothing more is to be traced for the revision.
  bool ended() const { return ended_; }

 private:
  std::uint64_t revision_ = 0;
  std::optional<accuracy::LightProgress> begun_at_;  // what was there before
  std::int64_t paths_ = 0;
  std::int64_t shown_paths_ = 0;
  Clock::time_point shown_at_;
  bool ended_ = false;
};

}  // namespace thunderhead::session
