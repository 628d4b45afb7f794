// A frame source whose pictures count in the memory budget before they are drawn, and which says so
// when its device is lost.
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
  // Counts the devices so far; a source belongs to the one at whose time it was made.
  const std::atomic<std::uint64_t>& generation;
  // Called on the thread that draws, whenever a picture failed with gl::DeviceLost, with the
  // source's device.
  std::function<void(std::uint64_t generation)> on_device_lost;
};

// Sources of `make`, guarded.
FrameSourceFactory GuardedSources(FrameSourceFactory make, SourceGuard guard);

}  // namespace thunderhead::drawing
