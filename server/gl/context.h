// A headless OpenGL 4.5 core context through EGL. It uses EGL's device platform to run on a GPU, or
// the surfaceless platform to run on Mesa's software renderer. This code does not use physics or
// scenes.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::gl {

struct ContextInfo {
  std::string device;          // "software" or "gpu 0"
  std::string renderer;        // GL_RENDERER
  std::string version;         // GL_VERSION
  bool tells_of_loss = false;  // true if the context reports loss of the device: gl/device_faults.h
};

// Owns an EGL display and context. Create, use and destroy it on one thread. The context is current
// from Create until its destruction.
class Context {
 public:
  // Creates a context. `device` is "auto" (the first GPU with a working driver, otherwise
  // software), "software", or the number of a GPU, counted from 0. Returns INVALID_ARGUMENT for any
  // other text, NOT_FOUND if there is no such GPU, and UNAVAILABLE if the driver of the GPU or the
  // software renderer does not work.
  static absl::StatusOr<std::unique_ptr<Context>> Create(std::string_view device);

  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  virtual const ContextInfo& Info() const = 0;

 protected:
  Context() = default;
};

}  // namespace thunderhead::gl
