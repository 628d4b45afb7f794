// Pictures at half the size, for viewers with a slow link or a small window.
#pragma once

#include "frame/fine_image.h"
#include "frame/image_codec.h"

namespace thunderhead::frame {

// Returns a picture of half the width and height, rounded up. Each pixel is the mean of four
// pixels, or of fewer at an odd edge. The mean is taken over sRGB values. It keeps the look of the
// picture but is not the mean of its linear light.
RgbImage Halved(const RgbImage& image);
FineImage Halved(const FineImage& image);

}  // namespace thunderhead::frame
