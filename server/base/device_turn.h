// The right to use a device that several threads draw on in turn.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

class DeviceTurn {
 public:
  virtual ~DeviceTurn() = default;

  // Waits for it. An error, CANCELLED if nobody wants what is drawn any more, ends the drawing.
  virtual absl::Status Take() = 0;
  virtual void GiveBack() = 0;
  // Why Take would end the drawing; OK while it would not. Does not wait; safe from any thread.
  virtual absl::Status Wanted() const { return absl::OkStatus(); }
};

}  // namespace thunderhead::base
