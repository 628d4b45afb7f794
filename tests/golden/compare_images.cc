// compare_images EXPECTED ACTUAL DIFFERENCE: exits 0 when two PNG pictures are the same to the eye,
// else says how they differ, writes the difference times eight, and exits 1.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "frame/image_codec.h"

namespace thunderhead {
namespace {

// Mesa's versions differ in the last bits of a texture fetch: a step of two in 255 anywhere, more
// only in pixels where a slice's edge falls to the other side.
constexpr double kMeanStep = 0.5;
constexpr int kLargeStep = 8;
constexpr double kShareOfLargeSteps = 0.002;

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
  std::vector<std::uint8_t> difference(actual->rgb.size());
  double sum = 0.0;
  double large = 0.0;
  for (std::size_t i = 0; i < difference.size(); ++i) {
    const int step = std::abs(int{expected->rgb[i]} - int{actual->rgb[i]});
    sum += step;
    large += step > kLargeStep ? 1.0 : 0.0;
    difference[i] = static_cast<std::uint8_t>(std::min(step * 8, 255));
  }
  const auto count = static_cast<double>(difference.size());
  if (sum / count <= kMeanStep && large / count <= kShareOfLargeSteps) return 0;
  std::cerr << "mean step " << sum / count << " of at most " << kMeanStep
            << ", share of steps over " << kLargeStep << " " << large / count << " of at most "
            << kShareOfLargeSteps << "\nexpected   " << expected_path << "\nactual     "
            << actual_path << "\ndifference " << difference_path << "\n";
  const auto png = frame::EncodePng(actual->width_px, actual->height_px, difference);
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
