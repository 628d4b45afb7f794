// The engine that draws with OpenGL: a context, the scene renderers and the tone mapper behind
// FrameSource.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "renderers/technique_registry.h"
#include "session/frame_source.h"

namespace thunderhead::session {

// The available techniques, in the order in which to offer them.
std::vector<TechniqueInfo> TechniquesOf(const renderers::TechniqueRegistry& registry);

// Sources that draw on a device, each with a context of its own that it opens (gl::Context::Create)
// on the calling thread, which must stay the one that draws. Light that one of them has traced is
// shown by all.
FrameSourceFactory GlFrameSources(const std::string& device);

}  // namespace thunderhead::session
