// A display picture in which most pixels are interpolated from pictures of a quarter and half its
// size. Only pixels that differ from the interpolation of their neighbours get their own rays
// (docs/decisions/0052-sparse-pictures.md). This code does not use GL.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "frame/fine_image.h"
#include "glm/vec2.hpp"

namespace thunderhead::frame {

// The pixels of the last picture are so small that their roughness is less visible. Rays have more
// effect in the picture before it (docs/decisions/0052-sparse-pictures.md).
inline constexpr double kLastContrast = 10.0 / 3.0;

// Returns the size of the first picture: a quarter of `size_px` along each side, rounded up.
glm::ivec2 CoarsestOf(const glm::ivec2& size_px);

// Returns the colours of chosen places, as FineImage has them, in the order of the places. Places
// range from (-1, -1), left and bottom, to (1, 1).
using DrawPlaces =
    std::function<absl::StatusOr<std::vector<std::uint16_t>>(const std::vector<glm::vec2>&)>;

// Computes the whole picture from its coarsest one. `contrast` limits the difference for which
// pixels are interpolated. It compares twice a pixel's value with the sum of its neighbours on both
// sides, in steps of 255 of any colour. For the last picture, the limit is multiplied by
// kLastContrast. `draw` is called for each of the two finer pictures, unless all of its pixels are
// interpolated.
absl::StatusOr<FineImage> CompletePicture(FineImage coarsest, const glm::ivec2& size_px,
                                          double contrast, const DrawPlaces& draw);

// Converts to 8 bits with the noise of post/tone_map.frag.
std::vector<std::uint8_t> Dithered(const FineImage& picture);

}  // namespace thunderhead::frame
