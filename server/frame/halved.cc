#include "frame/halved.h"

#include <algorithm>
#include <cstddef>

namespace thunderhead::frame {

RgbImage Halved(const RgbImage& image) {
  RgbImage half{(image.width_px + 1) / 2, (image.height_px + 1) / 2, {}};
  half.rgb.resize(static_cast<std::size_t>(half.width_px) *
                  static_cast<std::size_t>(half.height_px) * 3);
  const auto row_bytes = static_cast<std::size_t>(image.width_px) * 3;
  std::uint8_t* out = half.rgb.data();
  for (int y = 0; y < half.height_px; ++y) {
    const auto upper = static_cast<std::size_t>(2 * y);
    const auto lower = static_cast<std::size_t>(std::min(2 * y + 1, image.height_px - 1));
    const std::uint8_t* const top = image.rgb.data() + upper * row_bytes;
    const std::uint8_t* const bottom = image.rgb.data() + lower * row_bytes;
    for (int x = 0; x < half.width_px; ++x) {
      const auto left = static_cast<std::size_t>(2 * x) * 3;
      const auto right = static_cast<std::size_t>(std::min(2 * x + 1, image.width_px - 1)) * 3;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const int sum = top[left + channel] + top[right + channel] + bottom[left + channel] +
                        bottom[right + channel];
        *out++ = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

}  // namespace thunderhead::frame
