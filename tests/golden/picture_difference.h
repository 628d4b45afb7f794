// The difference between a picture and its stored golden picture.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame/image_codec.h"

namespace thunderhead::golden {

struct PictureDifference {
  double mean_step = 0.0;             // of all values, in levels of 255
  double share_of_large_steps = 0.0;  // share of steps of more than kLargeStep
  // The picture is divided into blocks. This is the largest mean shift of one colour in a block, up
  // or down, and that block's corner. Rounding goes both ways and leaves no shift. A brighter storm
  // shifts the blocks that it fills, however much of the picture is sky.
  double worst_shift = 0.0;
  int worst_x_px = 0;
  int worst_y_px = 0;

  std::string Text() const;
};

// Returns the difference of two pictures of the same size.
PictureDifference Difference(const frame::RgbImage& expected, const frame::RgbImage& actual);

// Returns true if the pictures look the same to the eye.
bool IsTheSame(const PictureDifference& difference);

}  // namespace thunderhead::golden
