// A picture as an OpenEXR file: linear radiance in R, G, B as 32-bit floats, and where the picture
// has them: its standard error in stderr.R, stderr.G, stderr.B, the share of each pixel that the
// storm covers in storm.opacity (of the depth that the renderer sees the background through, which
// is less than the whole: decision 44), the storm's optical depth in storm.optical_depth and the
// distance (m) at which that reaches 1 in storm.depth_one_distance, infinite where it does not.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "picture/linear_picture.h"

namespace thunderhead::picture {

// Texts about the picture, by name; in the header.
struct ExrAttributes {
  std::map<std::string, std::string> texts;
  std::map<std::string, float> numbers;
};

// The file's bytes.
absl::StatusOr<std::string> EncodeExr(const LinearPicture& picture,
                                      const ExrAttributes& attributes = {});

// Sets a number in the header of a file that EncodeExr made with that number.
void SetExrNumber(const std::string& name, float value, std::string* exr);

// The picture in a file's bytes, which `what` names in errors.
struct ExrPicture {
  LinearPicture picture;
  ExrAttributes attributes;
};
absl::StatusOr<ExrPicture> DecodeExr(const std::string& exr, const std::string& what);

absl::Status WriteExr(const std::string& path, const LinearPicture& picture,
                      const ExrAttributes& attributes = {});

// Reads what WriteExr wrote.
absl::StatusOr<LinearPicture> ReadExr(const std::string& path);

}  // namespace thunderhead::picture
