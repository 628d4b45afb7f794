// The engine that draws with OpenGL: implements FrameSource with a context, the scene renderers and
// the tone mapper.
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
  // The budget of GL objects is `memory` if the CPU draws, else `gpu_memory`. Null means no limit.
  std::shared_ptr<base::MemoryBudget> memory;
  std::shared_ptr<base::MemoryBudget> gpu_memory;
  std::function<std::unique_ptr<gl::DeviceWatch>()> watch_device = gl::WatchDevice;
};

// Returns a factory of sources that draw on a device. Each source opens its own context
// (gl::Context::Create) on the calling thread, which must remain the drawing thread. Light traced
// by one source is shown by all of them.
FrameSourceFactory GlFrameSources(const std::string& device, GlSourceOptions options = {});

}  // namespace thunderhead::drawing
