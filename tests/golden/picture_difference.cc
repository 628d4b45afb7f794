#include "tests/golden/picture_difference.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace thunderhead::golden {
namespace {

// Mesa's versions differ in the last bits of a texture fetch. That causes a step of two in 255
// anywhere, and more only in pixels where a slice's edge falls to the other side.
constexpr double kMaxMeanStep = 0.5;
constexpr int kLargeStep = 8;
constexpr double kMaxShareOfLargeSteps = 0.002;

// A block is smaller than a storm, so a storm that is brighter or darker shifts the mean of whole
// blocks. A block has so many pixels that a slice's edge in a few of them hardly shifts its mean.
// For the same reason a larger step counts as kMaxStepInShift.
constexpr int kBlock_px = 20;
constexpr int kMaxStepInShift = 2;
constexpr double kMaxShift = 0.25;

// Returns the mean shift of one colour in a block.
double ShiftOf(const frame::RgbImage& expected, const frame::RgbImage& actual, int low_x, int low_y,
               std::size_t color) {
  const int high_x = std::min(low_x + kBlock_px, expected.width_px);
  const int high_y = std::min(low_y + kBlock_px, expected.height_px);
  double sum = 0.0;
  for (int y = low_y; y < high_y; ++y) {
    for (int x = low_x; x < high_x; ++x) {
      const std::size_t at = 3 * static_cast<std::size_t>(y * expected.width_px + x) + color;
      sum += std::clamp(int{actual.rgb[at]} - int{expected.rgb[at]}, -kMaxStepInShift,
                        kMaxStepInShift);
    }
  }
  return sum / ((high_x - low_x) * (high_y - low_y));
}

}  // namespace

std::string PictureDifference::Text() const {
  std::ostringstream text;
  text << "mean step " << mean_step << " of at most " << kMaxMeanStep << ", share of steps over "
       << kLargeStep << " " << share_of_large_steps << " of at most " << kMaxShareOfLargeSteps
       << ", shift of a block " << worst_shift << " of at most " << kMaxShift << " (at "
       << worst_x_px << ", " << worst_y_px << ")";
  return text.str();
}

PictureDifference Difference(const frame::RgbImage& expected, const frame::RgbImage& actual) {
  PictureDifference found;
  for (std::size_t i = 0; i < expected.rgb.size(); ++i) {
    const int step = std::abs(int{expected.rgb[i]} - int{actual.rgb[i]});
    found.mean_step += step;
    found.share_of_large_steps += step > kLargeStep ? 1.0 : 0.0;
  }
  found.mean_step /= static_cast<double>(expected.rgb.size());
  found.share_of_large_steps /= static_cast<double>(expected.rgb.size());
  for (int y = 0; y < expected.height_px; y += kBlock_px) {
    for (int x = 0; x < expected.width_px; x += kBlock_px) {
      for (std::size_t color = 0; color < 3; ++color) {
        const double shift = ShiftOf(expected, actual, x, y, color);
        if (std::abs(shift) <= std::abs(found.worst_shift)) continue;
        found.worst_shift = shift;
        found.worst_x_px = x;
        found.worst_y_px = y;
      }
    }
  }
  return found;
}

bool IsTheSame(const PictureDifference& difference) {
  return difference.mean_step <= kMaxMeanStep &&
         difference.share_of_large_steps <= kMaxShareOfLargeSteps &&
         std::abs(difference.worst_shift) <= kMaxShift;
}

}  // namespace thunderhead::golden
