// Checks of a program against the text of its shaders, which tests switch on: GL ignores a uniform
// or a macro whose name is misspelt, and lets two textures share a unit. Knows no physics.
#pragma once

#include <epoxy/gl.h>

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "gl/program.h"

namespace thunderhead::gl {

// True where the environment has THUNDERHEAD_STRICT_PROGRAMS=1 when it is first asked.
bool StrictPrograms();

// Uniforms that `text` declares in any variant, one a line; samplers and images among them.
std::set<std::string, std::less<>> DeclaredUniforms(const std::string& text);

// INTERNAL names a define that no text mentions, or a macro in a condition that is defined neither
// by a define nor in its text. `texts` are those of a program's stages, without the defines.
absl::Status CheckDefines(const std::vector<std::string>& texts, const Defines& defines);

// INTERNAL names two samplers, two images or two storage buffers of a linked program with the same
// binding.
absl::Status CheckBindings(GLuint program);

}  // namespace thunderhead::gl
