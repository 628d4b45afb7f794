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
};

}  // namespace thunderhead::base
