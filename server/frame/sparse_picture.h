// A picture for display of which most pixels follow from pictures of a quarter and half its size:
// only those get rays of their own that differ from what their neighbours lead to expect
// (docs/decisions/0052-sparse-pictures.md). Knows no GL.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "frame/fine_image.h"
#include "glm/vec2.hpp"

namespace thunderhead::frame {

// The last picture's pixels are so small that their roughness is seen less: rays are better spent
// on the one before (docs/decisions/0052-sparse-pictures.md).
inline constexpr double kLastContrast = 10.0 / 3.0;

// The first picture of one of `size_px`: a quarter of it along each side, rounded up.
glm::ivec2 CoarsestOf(const glm::ivec2& size_px);

// Gives the colours of chosen places, as FineImage has them, in their order. Places run from (-1,
// -1), left and bottom, to (1, 1).
using DrawPlaces =
    std::function<absl::StatusOr<std::vector<std::uint16_t>>(const std::vector<glm::vec2>&)>;

// The whole picture from its coarsest. `contrast` is how far a pixel of it may lie off the middle
// of its neighbours on both sides, twice, in steps of 255 of any colour, for those in its place in
// the next picture to follow from it; for the last picture it is kLastContrast times as much.
// `draw` is called for each of the two finer pictures, unless all of it follows.
absl::StatusOr<FineImage> CompletePicture(FineImage coarsest, const glm::ivec2& size_px,
                                          double contrast, const DrawPlaces& draw);

// With 8 bits and the noise of post/tone_map.frag.
std::vector<std::uint8_t> Dithered(const FineImage& picture);

}  // namespace thunderhead::frame
