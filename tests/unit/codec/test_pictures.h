// Pictures that move, and the difference between two pictures.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "frame/image_codec.h"

namespace thunderhead::codec {

// Returns a picture of soft blobs in front of a gradient, moved by `shift_px` to the left.
inline frame::RgbImage MovingPicture(int width_px, int height_px, int shift_px) {
  frame::RgbImage picture{width_px, height_px, {}};
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const double blob = 0.5 + 0.5 * std::sin(0.09 * (x + shift_px)) * std::sin(0.11 * y);
      const double slope = static_cast<double>(y) / height_px;
      picture.rgb.push_back(static_cast<std::uint8_t>(40.0 + 160.0 * blob));
      picture.rgb.push_back(static_cast<std::uint8_t>(60.0 + 100.0 * blob + 60.0 * slope));
      picture.rgb.push_back(static_cast<std::uint8_t>(120.0 + 100.0 * slope));
    }
  }
  return picture;
}

// Returns the peak signal-to-noise ratio in dB.
inline double Psnr_dB(const frame::RgbImage& a, const frame::RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const double difference = static_cast<double>(a.rgb[i]) - b.rgb[i];
    sum += difference * difference;
  }
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(a.rgb.size()) / (sum + 1e-9));
}

}  // namespace thunderhead::codec
