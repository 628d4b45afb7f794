// The drawing engine on OpenGL. It implements FrameSource with a GL context, the scene renderers
// and the tone mapper.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "drawing/frame_source.h"
#include "gl/device_faults.h"
#include "renderers/technique_registry.h"

namespace thunderhead::drawing {

struct GlSourceOptions {
  // GL objects are reserved in `memory` if the CPU draws, else in `gpu_memory`. Null means no
  // limit.
  std::shared_ptr<base::MemoryBudget> memory;
  std::shared_ptr<base::MemoryBudget> gpu_memory;
  std::function<std::unique_ptr<gl::DeviceWatch>()> watch_device = gl::WatchDevice;
};

// Returns a factory of sources that draw on the device. Each source opens its own context
// (gl::Context::Create) on the thread that calls the factory, and must be used on that thread. All
// sources of the factory show the light that any of them has traced.
FrameSourceFactory GlFrameSources(const std::string& device, GlSourceOptions options = {});

}  // namespace thunderhead::drawing
