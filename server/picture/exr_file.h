// Stores a picture as an OpenEXR file. R, G, B hold linear radiance as 32-bit floats. Further
// channels exist if the picture has their values:
//
// - stderr.R, stderr.G, stderr.B: the standard error of the radiance.
// - storm.opacity: the share of each pixel that the storm covers. It is less than 1 - exp(-depth)
//   because the renderers count forward-scattered light as unscattered (decision 49).
// - storm.optical_depth: the optical depth of the storm along each pixel's ray.
// - storm.depth_one_distance: the distance (m) at which the optical depth reaches 1, or infinity.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "picture/linear_picture.h"

namespace thunderhead::picture {

// Named texts and numbers about the picture, stored in the file's header.
struct ExrAttributes {
  std::map<std::string, std::string> texts;
  std::map<std::string, float> numbers;
};

// Returns the file's bytes, or INTERNAL if OpenEXR fails.
absl::StatusOr<std::string> EncodeExr(const LinearPicture& picture,
                                      const ExrAttributes& attributes = {});

// Sets the number `name` in the file's header to `value`. EncodeExr must have made `exr` with a
// number of this name among its attributes.
void SetExrNumber(const std::string& name, float value, std::string* exr);

// A picture and its attributes, decoded from a file's bytes. Error messages name the file as
// `what`. DecodeExr returns INVALID_ARGUMENT for anything but a file of this format, and for a file
// with too few bytes for the picture's size in its header.
struct ExrPicture {
  LinearPicture picture;
  ExrAttributes attributes;
};
absl::StatusOr<ExrPicture> DecodeExr(const std::string& exr, const std::string& what);

absl::Status WriteExr(const std::string& path, const LinearPicture& picture,
                      const ExrAttributes& attributes = {});

// Reads a file that WriteExr wrote, and refuses a link or FIFO in its place. Returns
// INVALID_ARGUMENT if the file cannot be read or is not such a file.
absl::StatusOr<LinearPicture> ReadExr(const std::string& path);

}  // namespace thunderhead::picture
