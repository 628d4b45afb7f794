// The progress of tracing light for a view at rest, and when to show the improved picture. A plain
// value; the time is an argument.
#pragma once

#include <cstdint>
#include <optional>

#include "accuracy/light_progress.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class LightTracing {
 public:
  // Discards the progress if `revision` is new.
  void BeginFor(std::uint64_t revision, session::Clock::time_point now);

  // Records the progress of tracing. Returns true if the picture should be drawn again with the
  // light traced so far.
  bool Traced(const accuracy::LightProgress& progress, session::Clock::time_point now);
  // Records that the picture was drawn with the light traced so far.
  void Shown(session::Clock::time_point now);

  // Ends tracing for the revision. If `due` is true, the picture must be drawn once more.
  void GiveUp(bool due) {
    ended_ = true;
    due_ = due;
  }

  // Returns true if the picture must be drawn again.
  bool due() const { return due_; }
  // Returns true if no further light is traced for the revision.
  bool ended() const { return ended_; }

 private:
  std::uint64_t revision_ = 0;
  // Progress that earlier views had already made when this view began.
  std::optional<accuracy::LightProgress> begun_at_;
  std::int64_t paths_ = 0;
  std::int64_t shown_paths_ = 0;
  session::Clock::time_point shown_at_;
  bool ended_ = false;
  bool due_ = false;
};

}  // namespace thunderhead::drawing
