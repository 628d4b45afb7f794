// The exclusive right to use a device, such as the GPU. Several threads take turns in holding this
// right.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

class DeviceTurn {
 public:
  virtual ~DeviceTurn() = default;

  // Waits for the turn. An error means that the caller must stop drawing. The error is CANCELLED if
  // no caller needs the drawing any longer.
  virtual absl::Status Take() = 0;
  virtual void GiveBack() = 0;
  // Returns the error that Take would return to stop the drawing, or OK. Does not wait. Safe from
  // any thread.
  virtual absl::Status Wanted() const { return absl::OkStatus(); }
};

}  // namespace thunderhead::base
