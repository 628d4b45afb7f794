// Pictures at half the size, for viewers with a slow link or a small window.
#pragma once

#include "frame/fine_image.h"
#include "frame/image_codec.h"

namespace thunderhead::frame {

// Half the width and height, rounded up: each pixel the mean of four, of fewer at an odd edge. The
// mean is of sRGB values, which keeps a picture's look and is not its mean light.
RgbImage Halved(const RgbImage& image);
FineImage Halved(const FineImage& image);

}  // namespace thunderhead::frame
