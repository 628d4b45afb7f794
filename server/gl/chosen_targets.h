// A user's choice whether compute shaders or rasterization draw whole targets (gl/whole_target.h).
#pragma once

#include <optional>

namespace thunderhead::gl {

// Returns true for the text "compute" and false for "raster". Returns nothing for null, and for any
// other text, which is logged as an error.
std::optional<bool> ComputesByChoice(const char* chosen);

}  // namespace thunderhead::gl
