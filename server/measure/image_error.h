// How far a picture is from the truth: error of linear radiance, and of what a viewer sees. Pure
// functions of pixels; images are rows from top to bottom.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"
#include "picture/linear_picture.h"

namespace thunderhead::measure {

// 8-bit sRGB, three bytes a pixel.
struct DisplayImage {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
};

// Root of the mean squared difference over pixels and colours, over the truth's mean radiance. The
// images have one size; the truth is not black.
double RelativeRmse(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// The same of the truth's standard error, which it has: the RelativeRmse to expect between the
// exact picture and this truth.
double RelativeNoise(const picture::LinearPicture& truth);

// RelativeRmse without a noise of the truth of that RelativeNoise: the noise knows nothing of the
// picture, so that mean squares add up. 0 where it is all noise.
double RelativeRmseWithout(double truth_noise, const picture::LinearPicture& image,
                           const picture::LinearPicture& truth);

// Mean difference over the truth's mean radiance: above 0 where the picture is too bright.
double RelativeBias(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// The mean of the perceived difference, 0 to 1, by FLIP (Andersson et al. 2020, A Difference
// Evaluator for Alternating Images) at 67 pixels a degree: colours after the eye's contrast
// sensitivity, and edges and points.
double Flip(const DisplayImage& image, const DisplayImage& truth);

}  // namespace thunderhead::measure
