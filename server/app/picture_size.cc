#include "app/picture_size.h"

#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace thunderhead::app {
namespace {

constexpr int kMaxSide_px = 8192;  // as in proto/thunderhead/v1/scene.proto

}  // namespace

absl::StatusOr<PictureSize> ParsePictureSize(const std::string& size, const std::string& flag) {
  const std::vector<std::string> sides = absl::StrSplit(size, 'x');
  PictureSize parsed;
  if (sides.size() != 2 || !absl::SimpleAtoi(sides[0], &parsed.width_px) ||
      !absl::SimpleAtoi(sides[1], &parsed.height_px)) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " is '", size, "'; it must be WIDTHxHEIGHT, for example 1280x720"));
  }
  for (const int side_px : {parsed.width_px, parsed.height_px}) {
    if (side_px >= 1 && side_px <= kMaxSide_px) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        flag, " is '", size, "'; each side must be from 1 to ", kMaxSide_px, " pixels"));
  }
  return parsed;
}

}  // namespace thunderhead::app
