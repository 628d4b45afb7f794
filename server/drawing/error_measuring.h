// The measured error of a view at rest, and when to tell it. A plain value; the time is an
// argument.
#pragma once

#include <cstdint>
#include <optional>

#include "accuracy/error_meters.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class ErrorMeasuring {
 public:
  // Starts again if the revision is a new one.
  void BeginFor(std::uint64_t revision);

  // Records progress. True if it should be told.
  bool Measured(const accuracy::ErrorProgress& progress, session::Clock::time_point now);
  // Records that a frame tells the error measured so far.
  void Told(session::Clock::time_point now);

  // Nothing is measured for the revision.
  void GiveUp();

  const std::optional<accuracy::MeasuredError>& error() const { return error_; }
  // True if a frame is to tell it.
  bool due() const { return due_; }
  // True while nothing more is measured, unless the picture becomes a better one.
  bool ended() const { return ended_; }

 private:
  std::uint64_t revision_ = 0;
  std::optional<accuracy::MeasuredError> error_;
  std::optional<accuracy::MeasuredError> told_;
  session::Clock::time_point told_at_;
  bool ended_ = false;
  bool due_ = false;
};

}  // namespace thunderhead::drawing
