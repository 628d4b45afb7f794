// The GL context of a test.
#pragma once

#include <cstdlib>
#include <memory>

#include "absl/status/statusor.h"
#include "gl/context.h"

namespace thunderhead::test_support {

// Software GL, which every machine draws alike; or the device that THUNDERHEAD_TEST_DEVICE names,
// as `--device` does.
inline absl::StatusOr<std::unique_ptr<gl::Context>> OpenContext() {
  const char* device = std::getenv("THUNDERHEAD_TEST_DEVICE");
  return gl::Context::Create(device == nullptr ? "software" : device);
}

}  // namespace thunderhead::test_support
