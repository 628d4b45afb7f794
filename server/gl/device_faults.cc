#include "gl/device_faults.h"

#include <epoxy/gl.h>

#include <chrono>

#include "base/error_details.h"

namespace thunderhead::gl {
namespace {

constexpr char kLostReason[] = "DEVICE_LOST";
constexpr char kOutOfMemoryReason[] = "OUT_OF_DEVICE_MEMORY";
// Retry delays for clients. kLostFor is the time until the device is available again. kFullFor is
// the time until other programs need less of its memory.
constexpr std::chrono::seconds kLostFor{5};
constexpr std::chrono::seconds kFullFor{10};
// Maximum number of errors read at once, because a lost context may report errors without end.
constexpr int kMaxErrors = 16;

class GlWatch final : public DeviceWatch {
 public:
  Fault Look() override {
    if (glGetGraphicsResetStatus() != GL_NO_ERROR) return Fault::kLost;
    Fault fault = Fault::kNone;
    for (int i = 0; i < kMaxErrors; ++i) {
      const GLenum error = glGetError();
      if (error == GL_NO_ERROR) break;
      if (error == GL_CONTEXT_LOST) return Fault::kLost;
      if (error == GL_OUT_OF_MEMORY) fault = Fault::kOutOfMemory;
    }
    return fault;
  }
};

}  // namespace

std::unique_ptr<DeviceWatch> WatchDevice() { return std::make_unique<GlWatch>(); }

absl::Status DeviceLost() {
  return base::WithDetails(
      absl::UnavailableError(
          "the device was reset and is being opened again; try again in a few seconds"),
      {.reason = kLostReason, .retry_after = kLostFor});
}

bool IsDeviceLost(const absl::Status& status) {
  return !status.ok() && base::DetailsOf(status).reason == kLostReason;
}

absl::Status OutOfDeviceMemory() {
  return base::WithDetails(
      absl::ResourceExhaustedError("the device does not have enough memory for this; request fewer "
                                   "pixels, or try again later, when other viewers need less"),
      {.reason = kOutOfMemoryReason, .retry_after = kFullFor});
}

bool IsOutOfDeviceMemory(const absl::Status& status) {
  return !status.ok() && base::DetailsOf(status).reason == kOutOfMemoryReason;
}

absl::Status StatusOf(DeviceWatch::Fault fault) {
  switch (fault) {
    case DeviceWatch::Fault::kNone:
      return absl::OkStatus();
    case DeviceWatch::Fault::kLost:
      return DeviceLost();
    case DeviceWatch::Fault::kOutOfMemory:
      return OutOfDeviceMemory();
  }
  return absl::OkStatus();
}

absl::Status FaultNow() { return StatusOf(WatchDevice()->Look()); }

}  // namespace thunderhead::gl
