#include "gl/device.h"

#include <epoxy/gl.h>

#include "absl/strings/match.h"

namespace thunderhead::gl {

bool DrawsInSoftware() {
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return renderer != nullptr && absl::StrContains(renderer, "llvmpipe");
}

}  // namespace thunderhead::gl
