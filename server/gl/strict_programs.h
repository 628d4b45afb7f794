// Checks of a program against the text of its shaders, which tests enable. GL ignores a uniform or
// a macro with a misspelt name, and lets two textures use one unit. This code does not use physics.
#pragma once

#include <epoxy/gl.h>

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "gl/program.h"

namespace thunderhead::gl {

// Returns true if the environment had THUNDERHEAD_STRICT_PROGRAMS=1 at the first call.
bool StrictPrograms();

// Returns the uniforms that `text` declares in any variant, one a line, including samplers and
// images.
std::set<std::string, std::less<>> DeclaredUniforms(const std::string& text);

// Checks the defines. INTERNAL names a define that no text mentions, or a macro in a condition
// without a definition. The definition may be a define or in its text. `texts` are those of a
// program's stages, without the defines.
absl::Status CheckDefines(const std::vector<std::string>& texts, const Defines& defines);

// Checks a linked program. INTERNAL names two samplers, two images or two storage buffers with the
// same binding.
absl::Status CheckBindings(GLuint program);

}  // namespace thunderhead::gl
