// The exclusive right to use a device, which several threads take in turn.
#pragma once

#include "absl/status/status.h"

namespace thunderhead::base {

class DeviceTurn {
 public:
  virtual ~DeviceTurn() = default;

  // Waits for the turn. An error means that the caller must stop drawing. It is CANCELLED if no
  // caller needs the result any longer.
  virtual absl::Status Take() = 0;
  virtual void GiveBack() = 0;
  // Returns the error with which Take would stop the drawing, or OK. Does not wait. Safe from any
  // thread.
  virtual absl::Status Wanted() const { return absl::OkStatus(); }
};

}  // namespace thunderhead::base
