// Checks of a program against the text of its shaders, which tests enable. GL itself ignores a
// uniform or a macro with a misspelt name, and lets two textures use one unit. This code does not
// use physics.
#pragma once

#include <epoxy/gl.h>

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "gl/program.h"

namespace thunderhead::gl {

// Returns true if THUNDERHEAD_STRICT_PROGRAMS was 1 in the environment at the first call.
bool StrictPrograms();

// Returns the names of the uniforms that `text` declares in any variant, including samplers and
// images. Each uniform must be declared on its own line.
std::set<std::string, std::less<>> DeclaredUniforms(const std::string& text);

// Checks the macros of a program. Returns INTERNAL with the name of a define that no text mentions,
// or of an undefined macro in a preprocessor condition. A macro may be defined by `defines` or by
// the text itself. `texts` are the shader texts of the program's stages, without the defines.
absl::Status CheckDefines(const std::vector<std::string>& texts, const Defines& defines);

// Checks a linked program. Returns INTERNAL with the names of two samplers, two images or two
// storage buffers that have the same binding.
absl::Status CheckBindings(GLuint program);

}  // namespace thunderhead::gl
