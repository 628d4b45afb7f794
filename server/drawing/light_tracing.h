// The progress of tracing light for a view at rest, and when to show it. A plain value; the time is
// an argument.
#pragma once

#include <cstdint>
#include <optional>

#include "accuracy/light_progress.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class LightTracing {
 public:
  // Starts again if the revision is a new one.
  void BeginFor(std::uint64_t revision, session::Clock::time_point now);

  // Records progress. True if the picture should be drawn again with it.
  bool Traced(const accuracy::LightProgress& progress, session::Clock::time_point now);
  // Records that the picture was drawn with the light traced so far.
  void Shown(session::Clock::time_point now);

  // Ends tracing for the revision; the picture is to be drawn once more if it is due.
  void GiveUp(bool due) {
    ended_ = true;
    due_ = due;
  }

  // True if the picture is to be drawn again.
  bool due() const { return due_; }
  // True if no more light is traced for the revision.
  bool ended() const { return ended_; }

 private:
  std::uint64_t revision_ = 0;
  std::optional<accuracy::LightProgress> begun_at_;  // progress before this view, from earlier ones
  std::int64_t paths_ = 0;
  std::int64_t shown_paths_ = 0;
  session::Clock::time_point shown_at_;
  bool ended_ = false;
  bool due_ = false;
};

}  // namespace thunderhead::drawing
