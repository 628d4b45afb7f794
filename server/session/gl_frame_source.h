// The engine that draws with OpenGL: a context, the scene renderer and the tone mapper behind
// FrameSource.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/frame_source.h"

namespace thunderhead::session {

// Opens the device (gl::Context::Create) on the calling thread, which must stay the one that draws.
absl::StatusOr<std::unique_ptr<FrameSource>> MakeGlFrameSource(const std::string& device);

}  // namespace thunderhead::session
