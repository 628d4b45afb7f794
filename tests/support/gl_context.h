// The GL context of a test.
#pragma once

#include <cstdlib>
#include <memory>

#include "absl/status/statusor.h"
#include "gl/context.h"

namespace thunderhead::test_support {

// Returns the device of the test. The default is software GL, which gives the same pictures on
// every machine. THUNDERHEAD_TEST_DEVICE names another device, like `--device`.
inline const char* Device() {
  const char* device = std::getenv("THUNDERHEAD_TEST_DEVICE");
  return device == nullptr ? "software" : device;
}

inline absl::StatusOr<std::unique_ptr<gl::Context>> OpenContext() {
  return gl::Context::Create(Device());
}

}  // namespace thunderhead::test_support
