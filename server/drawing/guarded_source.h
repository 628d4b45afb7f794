// A frame source that reserves memory for each picture before drawing it, and reports the loss of
// its device.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "base/memory_budget.h"
#include "drawing/frame_source.h"

namespace thunderhead::drawing {

struct SourceGuard {
  std::shared_ptr<base::MemoryBudget> memory;
  // Counts the devices opened so far. A source belongs to the device that was open when it was
  // made.
  const std::atomic<std::uint64_t>& generation;
  // Called on the drawing thread, with the source's device, when a picture failed with
  // gl::DeviceLost.
  std::function<void(std::uint64_t generation)> on_device_lost;
};

// Returns a factory of guarded sources made by `make`.
FrameSourceFactory GuardedSources(FrameSourceFactory make, SourceGuard guard);

}  // namespace thunderhead::drawing
