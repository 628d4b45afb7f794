#include "frame/halved.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace thunderhead::frame {
namespace {

template <typename Image>
Image HalvedImage(const Image& image) {
  using Value = typename decltype(image.rgb)::value_type;
  Image half{(image.width_px + 1) / 2, (image.height_px + 1) / 2, {}};
  half.rgb.resize(static_cast<std::size_t>(half.width_px) *
                  static_cast<std::size_t>(half.height_px) * 3);
  const auto row_values = static_cast<std::size_t>(image.width_px) * 3;
  Value* out = half.rgb.data();
  for (int y = 0; y < half.height_px; ++y) {
    const auto upper = static_cast<std::size_t>(2 * y);
    const auto lower = static_cast<std::size_t>(std::min(2 * y + 1, image.height_px - 1));
    const Value* const top = image.rgb.data() + upper * row_values;
    const Value* const bottom = image.rgb.data() + lower * row_values;
    for (int x = 0; x < half.width_px; ++x) {
      const auto left = static_cast<std::size_t>(2 * x) * 3;
      const auto right = static_cast<std::size_t>(std::min(2 * x + 1, image.width_px - 1)) * 3;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const int sum = top[left + channel] + top[right + channel] + bottom[left + channel] +
                        bottom[right + channel];
        *out++ = static_cast<Value>((sum + 2) / 4);
      }
    }
  }
  return half;
}

}  // namespace

RgbImage Halved(const RgbImage& image) { return HalvedImage(image); }

FineImage Halved(const FineImage& image) { return HalvedImage(image); }

}  // namespace thunderhead::frame
