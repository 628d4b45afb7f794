// A frame source that reserves memory for each picture before drawing it, and reports when its
// device is lost.
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
  // Number of devices opened so far. A source belongs to the device that was open when the source
  // was created.
  const std::atomic<std::uint64_t>& generation;
  // Called on the drawing thread when a picture failed with gl::DeviceLost. `generation` identifies
  // the source's device.
  std::function<void(std::uint64_t generation)> on_device_lost;
};

// Returns a factory that wraps the sources of `make` in guarded sources.
FrameSourceFactory GuardedSources(FrameSourceFactory make, SourceGuard guard);

}  // namespace thunderhead::drawing
