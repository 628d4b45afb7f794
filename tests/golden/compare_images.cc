// compare_images EXPECTED ACTUAL DIFFERENCE: exits 0 when two PNG pictures look the same to the
// eye. Otherwise it reports how they differ, writes the difference times eight, and exits 1.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "frame/image_codec.h"
#include "tests/golden/picture_difference.h"

namespace thunderhead {
namespace {

absl::StatusOr<frame::RgbImage> Read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(path + " cannot be read; build the target update_golden");
  return frame::DecodePng(std::string(std::istreambuf_iterator<char>(file), {}));
}

int Compare(const std::string& expected_path, const std::string& actual_path,
            const std::string& difference_path) {
  const auto expected = Read(expected_path);
  const auto actual = Read(actual_path);
  for (const auto* image : {&expected, &actual}) {
    if (!image->ok()) {
      std::cerr << image->status().message() << "\n";
      return 1;
    }
  }
  if (expected->width_px != actual->width_px || expected->height_px != actual->height_px) {
    std::cerr << "expected " << expected->width_px << "x" << expected->height_px << ", got "
              << actual->width_px << "x" << actual->height_px << "\n";
    return 1;
  }
  const golden::PictureDifference difference = golden::Difference(*expected, *actual);
  if (golden::IsTheSame(difference)) return 0;
  std::cerr << difference.Text() << "\nexpected   " << expected_path << "\nactual     "
            << actual_path << "\ndifference " << difference_path << "\n";
  std::vector<std::uint8_t> steps(actual->rgb.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int step = std::abs(int{expected->rgb[i]} - int{actual->rgb[i]});
    steps[i] = static_cast<std::uint8_t>(std::min(step * 8, 255));
  }
  const auto png = frame::EncodePng(actual->width_px, actual->height_px, steps);
  if (png.ok()) std::ofstream(difference_path, std::ios::binary) << *png;
  return 1;
}

}  // namespace
}  // namespace thunderhead

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: compare_images EXPECTED ACTUAL DIFFERENCE\n";
    return 2;
  }
  return thunderhead::Compare(argv[1], argv[2], argv[3]);
}
