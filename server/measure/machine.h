// Describes the machine of a measurement.
#pragma once

#include <string>

#include "gl/context.h"

namespace thunderhead::measure {

struct Machine {
  std::string processor;  // name reported by the system
  int threads = 0;        // number of parallel threads
  std::string device;     // "software" or "gpu 0"
  std::string gl_renderer;
  std::string gl_version;
};

Machine MachineOf(const gl::ContextInfo& context);

std::string ToJson(const Machine& machine);

// Returns `text` as a JSON string.
std::string JsonText(const std::string& text);

}  // namespace thunderhead::measure
