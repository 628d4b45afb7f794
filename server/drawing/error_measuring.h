// The measured error of a view at rest, and when to report it. A plain value; the time is an
// argument.
#pragma once

#include <cstdint>
#include <optional>

#include "accuracy/error_meters.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class ErrorMeasuring {
 public:
  // Discards the measurement if `revision` is new.
  void BeginFor(std::uint64_t revision);

  // Records the progress of the measurement. Returns true if a frame should report the error now.
  bool Measured(const accuracy::ErrorProgress& progress, session::Clock::time_point now);
  // Records that a frame has reported the error measured so far.
  void Told(session::Clock::time_point now);

  // Records that no error is measured for the revision.
  void GiveUp();

  const std::optional<accuracy::MeasuredError>& error() const { return error_; }
  // Returns true if a frame must report the error.
  bool due() const { return due_; }
  // Returns true if the measurement has ended. It continues only if the picture's light improves.
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
