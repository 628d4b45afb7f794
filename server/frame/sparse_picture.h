// A display picture in which most pixels are interpolated. It is built from pictures of a quarter
// and half its size. Only pixels that differ from the interpolation of their neighbours get their
// own rays (docs/decisions/0052-sparse-pictures.md). This code does not use GL.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "frame/fine_image.h"
#include "glm/vec2.hpp"

namespace thunderhead::frame {

// Factor of the contrast limit for the last, full-size picture. The pixels of this picture are so
// small that roughness is hardly visible. Rays improve the result more in the half-size picture
// that is completed before it (docs/decisions/0052-sparse-pictures.md).
inline constexpr double kLastContrast = 10.0 / 3.0;

// Returns the size of the first picture: a quarter of `size_px` in each direction, rounded up.
glm::ivec2 CoarsestOf(const glm::ivec2& size_px);

// A callback that draws rays through the given places and returns their colours, in the format of
// FineImage and in the order of the places. Coordinates range from (-1, -1) at the lower left to
// (1, 1) at the upper right.
using DrawPlaces =
    std::function<absl::StatusOr<std::vector<std::uint16_t>>(const std::vector<glm::vec2>&)>;

// Computes the whole picture from its coarsest version. A pixel of a finer picture is interpolated
// if the pixel that contains it in the coarser picture has at most the contrast `contrast`. A
// pixel's contrast is the difference between twice its value and the sum of its two neighbours on
// opposite sides. The largest difference over the four directions and three colours counts, in
// steps of 1/255. For the last picture, the limit is multiplied by kLastContrast. `draw` is called
// once for each of the two finer pictures, unless all pixels of that picture are interpolated.
absl::StatusOr<FineImage> CompletePicture(FineImage coarsest, const glm::ivec2& size_px,
                                          double contrast, const DrawPlaces& draw);

// Converts to 8 bits with the dither noise of post/tone_map.frag.
std::vector<std::uint8_t> Dithered(const FineImage& picture);

}  // namespace thunderhead::frame
