// Differences between a picture and the truth: errors of linear radiance, and perceived ones. Pure
// functions of pixels; images are rows from top to bottom.
#pragma once

#include <vector>

#include "frame/image_codec.h"
#include "picture/linear_picture.h"

namespace thunderhead::measure {

// The picture without the pixels of `left_out`, one for each of its own: the others in one row.
picture::LinearPicture Without(const std::vector<bool>& left_out,
                               const picture::LinearPicture& image);

// Root mean square of the difference over pixels and colours, relative to the truth's mean
// radiance. The images must have the same size and the truth must not be black.
double RelativeRmse(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// The same of the truth's standard error, which must be present: the expected RelativeRmse between
// the exact picture and this truth.
double RelativeNoise(const picture::LinearPicture& truth);

// RelativeRmse after subtracting the truth's RelativeNoise: the noise is independent of the
// picture, so mean squares add up. 0 if the difference is all noise.
double RelativeRmseWithout(double truth_noise, const picture::LinearPicture& image,
                           const picture::LinearPicture& truth);

// Mean difference, relative to the truth's mean radiance: above 0 if the picture is too bright.
double RelativeBias(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// The mean of the perceived difference, 0 to 1, by FLIP (Andersson et al. 2020, A Difference
// Evaluator for Alternating Images) at 67 pixels a degree: colours after the eye's contrast
// sensitivity, and edges and points.
double Flip(const frame::RgbImage& image, const frame::RgbImage& truth);

}  // namespace thunderhead::measure
