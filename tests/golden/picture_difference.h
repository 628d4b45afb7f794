// How far a picture is from the one that is kept of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame/image_codec.h"

namespace thunderhead::golden {

struct PictureDifference {
  double mean_step = 0.0;             // of all values, of 255
  double share_of_large_steps = 0.0;  // steps of more than kLargeStep
  // The largest mean shift of one colour in one of the blocks that the picture is divided into, up
  // or down, and that block's corner. Rounding goes both ways and leaves no shift; a storm that is
  // brighter shifts the blocks that it fills, however much of the picture is sky.
  double worst_shift = 0.0;
  int worst_x_px = 0;
  int worst_y_px = 0;

  std::string Text() const;
};

// Both have the same size.
PictureDifference Difference(const frame::RgbImage& expected, const frame::RgbImage& actual);

// True if the pictures are the same to the eye.
bool IsTheSame(const PictureDifference& difference);

}  // namespace thunderhead::golden
