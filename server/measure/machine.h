// A description of the machine on which a measurement ran.
#pragma once

#include <string>

#include "gl/context.h"

namespace thunderhead::measure {

struct Machine {
  std::string processor;  // name reported by the system
  int threads = 0;        // number of threads that run in parallel
  std::string device;     // "software" or "gpu 0"
  std::string gl_renderer;
  std::string gl_version;
};

Machine MachineOf(const gl::ContextInfo& context);

std::string ToJson(const Machine& machine);

// Returns `text` as a quoted JSON string.
std::string JsonText(const std::string& text);

}  // namespace thunderhead::measure
