// Faults of the device while it draws: a reset, after which it has forgotten everything (a driver's
// crash, a watchdog, another program), or no memory left. Checked at the end of each picture.
// Knows no scene.
#pragma once

#include <memory>

#include "absl/status/status.h"

namespace thunderhead::gl {

// Whom to ask; tests ask a fake.
class DeviceWatch {
 public:
  enum class Fault { kNone, kLost, kOutOfMemory };

  virtual ~DeviceWatch() = default;
  // Since the last call, of the thread's context. After kLost the context is of no use any more.
  virtual Fault Look() = 0;
};

// glGetGraphicsResetStatus and glGetError. Without a robust context a loss goes unnoticed.
std::unique_ptr<DeviceWatch> WatchDevice();

// UNAVAILABLE with the reason DEVICE_LOST: every GL object is gone, and all that was drawn with
// this context fails.
absl::Status DeviceLost();
bool IsDeviceLost(const absl::Status& status);

// RESOURCE_EXHAUSTED with the reason OUT_OF_DEVICE_MEMORY.
absl::Status OutOfDeviceMemory();
bool IsOutOfDeviceMemory(const absl::Status& status);

absl::Status StatusOf(DeviceWatch::Fault fault);

// StatusOf what WatchDevice sees now.
absl::Status FaultNow();

}  // namespace thunderhead::gl
