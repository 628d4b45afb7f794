// Differences between a picture and the path-traced reference picture: errors of linear radiance,
// and perceived differences. The functions are pure. Images have rows from top to bottom.
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
double RelativeRmse(const picture::LinearPicture& image, const picture::LinearPicture& reference);

// Returns the root mean square of the reference's standard error, relative to its mean radiance.
// The standard error must be present. The result is the expected RelativeRmse between the exact
// picture and this reference.
double RelativeNoise(const picture::LinearPicture& reference);

// Returns RelativeRmse without the part that the reference's noise causes. `reference_noise` is
// RelativeNoise of the reference. The noise is independent of the picture, so its mean square is
// subtracted. The result is 0 if the whole difference is noise.
double RelativeRmseWithout(double reference_noise, const picture::LinearPicture& image,
                           const picture::LinearPicture& reference);

// Returns the mean difference relative to the reference's mean radiance. It is positive if the
// picture is too bright.
double RelativeBias(const picture::LinearPicture& image, const picture::LinearPicture& reference);

// Returns the mean perceived difference, 0 to 1, by FLIP at 67 pixels per degree. FLIP compares
// colours after the eye's contrast sensitivity, and edges and points (Andersson et al. 2020, A
// Difference Evaluator for Alternating Images).
double Flip(const frame::RgbImage& image, const frame::RgbImage& reference);

}  // namespace thunderhead::measure
