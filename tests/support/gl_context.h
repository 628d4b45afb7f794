// Chooses the device on which a test makes its OpenGL context.
#pragma once

#include <cstdlib>
#include <memory>

#include "absl/status/statusor.h"
#include "gl/context.h"

namespace thunderhead::test_support {

// Returns the device of the test. The default is the software renderer, which draws the same
// pictures on every machine. The environment variable THUNDERHEAD_TEST_DEVICE can name another
// device, with the values of the flag `--device`.
inline const char* Device() {
  const char* device = std::getenv("THUNDERHEAD_TEST_DEVICE");
  return device == nullptr ? "software" : device;
}

inline absl::StatusOr<std::unique_ptr<gl::Context>> OpenContext() {
  return gl::Context::Create(Device());
}

}  // namespace thunderhead::test_support
