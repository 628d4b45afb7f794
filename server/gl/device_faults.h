// Faults of the device during drawing: it was reset, or its memory is exhausted. A reset is caused
// by a crash of the driver, a watchdog or another program. After a reset the device has lost all
// objects. Faults are checked at the end of each picture. This code does not use scenes.
#pragma once

#include <memory>

#include "absl/status/status.h"

namespace thunderhead::gl {

// The source of faults. Tests replace it by a fake.
class DeviceWatch {
 public:
  enum class Fault { kNone, kLost, kOutOfMemory };

  virtual ~DeviceWatch() = default;
  // Returns the fault of the thread's context since the last call. After kLost the context is
  // unusable.
  virtual Fault Look() = 0;
};

// Returns a watch that uses glGetGraphicsResetStatus and glGetError. It does not detect a loss if
// the context is not robust.
std::unique_ptr<DeviceWatch> WatchDevice();

// Returns UNAVAILABLE with the reason DEVICE_LOST. Every GL object is lost, and all pending drawing
// with this context fails.
absl::Status DeviceLost();
bool IsDeviceLost(const absl::Status& status);

// Returns RESOURCE_EXHAUSTED with the reason OUT_OF_DEVICE_MEMORY.
absl::Status OutOfDeviceMemory();
bool IsOutOfDeviceMemory(const absl::Status& status);

absl::Status StatusOf(DeviceWatch::Fault fault);

// Checks the device with WatchDevice and returns StatusOf the fault.
absl::Status FaultNow();

}  // namespace thunderhead::gl
