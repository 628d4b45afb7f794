// Differences between a picture and the reference: errors of linear radiance, and perceived
// differences. Pure functions of pixels; images are rows from top to bottom.
#pragma once

#include <vector>

#include "frame/image_codec.h"
#include "picture/linear_picture.h"

namespace thunderhead::measure {

// Returns the picture without the pixels that are set in `left_out`, as a single row.
picture::LinearPicture Without(const std::vector<bool>& left_out,
                               const picture::LinearPicture& image);

// Returns the root mean square of the difference over pixels and colours, relative to the
// reference's mean radiance. The images must have the same size, and the reference must not be
// black.
double RelativeRmse(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// Returns the same for the reference's standard error, which must be present. It is the expected
// RelativeRmse between the exact picture and this reference.
double RelativeNoise(const picture::LinearPicture& truth);

// Returns RelativeRmse after subtracting the reference's RelativeNoise. The noise is independent of
// the picture, so mean squares add up. 0 if the difference is all noise.
double RelativeRmseWithout(double truth_noise, const picture::LinearPicture& image,
                           const picture::LinearPicture& truth);

// Returns the mean difference relative to the reference's mean radiance. It is above 0 if the
// picture is too bright.
double RelativeBias(const picture::LinearPicture& image, const picture::LinearPicture& truth);

// Returns the mean perceived difference, 0 to 1, by FLIP (Andersson et al. 2020, A Difference
// Evaluator for Alternating Images) at 67 pixels per degree. It compares colours after the eye's
// contrast sensitivity, and edges and points.
double Flip(const frame::RgbImage& image, const frame::RgbImage& truth);

}  // namespace thunderhead::measure
