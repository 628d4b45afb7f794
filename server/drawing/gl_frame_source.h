// The engine that draws with OpenGL: a context, the scene renderers and the tone mapper behind
// FrameSource.
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
  // The budget of GL objects: of the machine where its processors draw, else of the GPU. Null:
  // nothing is refused.
  std::shared_ptr<base::MemoryBudget> memory;
  std::shared_ptr<base::MemoryBudget> gpu_memory;
  std::function<std::unique_ptr<gl::DeviceWatch>()> watch_device = gl::WatchDevice;
};

// Sources that draw on a device, each with a context of its own that it opens (gl::Context::Create)
// on the calling thread, which must stay the one that draws. Light that one of them has traced is
// shown by all.
FrameSourceFactory GlFrameSources(const std::string& device, GlSourceOptions options = {});

}  // namespace thunderhead::drawing
