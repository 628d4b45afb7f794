// A headless OpenGL 4.5 core context through EGL: on a GPU by the device platform, else on Mesa's
// software renderer by the surfaceless platform. Knows no physics and no scene.
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
  bool tells_of_loss = false;  // gl/device_faults.h
};

// Owns an EGL display and context. Make it, use it and destroy it on one thread; it is current from
// Create to its end.
class Context {
 public:
  // `device` is "auto" (the first GPU whose driver works, else software), "software", or a number
  // N: the Nth GPU, and an error if there is no such GPU or its driver does not work.
  static absl::StatusOr<std::unique_ptr<Context>> Create(std::string_view device);

  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  virtual const ContextInfo& Info() const = 0;

 protected:
  Context() = default;
};

}  // namespace thunderhead::gl
