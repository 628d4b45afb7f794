// A traced picture as an OpenEXR file: linear radiance in R, G, B as 32-bit floats, its standard
// error in stderr.R, stderr.G, stderr.B, and where it is known the share of each pixel that the
// storm covers in storm.opacity.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "picture/linear_picture.h"

namespace thunderhead::picture {

// The picture has a standard error.
absl::Status WriteExr(const std::string& path, const LinearPicture& picture);

// Reads what WriteExr wrote.
absl::StatusOr<LinearPicture> ReadExr(const std::string& path);

}  // namespace thunderhead::picture
