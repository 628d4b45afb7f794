// A reference image as an OpenEXR file: linear radiance in R, G, B as 32-bit floats, and its
// standard error in stderr.R, stderr.G, stderr.B.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "reference/path_tracer.h"

namespace thunderhead::reference {

absl::Status WriteExr(const std::string& path, const Image& image);

// Reads what WriteExr wrote.
absl::StatusOr<Image> ReadExr(const std::string& path);

}  // namespace thunderhead::reference
