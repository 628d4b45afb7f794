// Faults of the device while it draws: a reset, or no memory left. After a reset (a driver's crash,
// a watchdog, another program) the device has lost all objects. Faults are checked at the end of
// each picture. This code does not use scenes.
#pragma once

#include <memory>

#include "absl/status/status.h"

namespace thunderhead::gl {

// The source of faults, which tests replace by a fake.
class DeviceWatch {
 public:
  enum class Fault { kNone, kLost, kOutOfMemory };

  virtual ~DeviceWatch() = default;
  // Returns the fault of the thread's context since the last call. After kLost the context is
  // unusable.
  virtual Fault Look() = 0;
};

// Returns a watch that uses glGetGraphicsResetStatus and glGetError. Without a robust context, a
// loss is not detected.
std::unique_ptr<DeviceWatch> WatchDevice();

// Returns UNAVAILABLE with the reason DEVICE_LOST. Every GL object is gone, and all pending drawing
// with this context fails.
absl::Status DeviceLost();
bool IsDeviceLost(const absl::Status& status);

// Returns RESOURCE_EXHAUSTED with the reason OUT_OF_DEVICE_MEMORY.
absl::Status OutOfDeviceMemory();
bool IsOutOfDeviceMemory(const absl::Status& status);

absl::Status StatusOf(DeviceWatch::Fault fault);

// Returns StatusOf the fault that WatchDevice reports now.
absl::Status FaultNow();

}  // namespace thunderhead::gl
