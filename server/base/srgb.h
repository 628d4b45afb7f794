// The transfer function of sRGB (IEC 61966-2-1), between linear light and display values, both from
// 0 to 1.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace thunderhead::base {

inline double SrgbOfLinear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

inline double LinearOfSrgb(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

inline double LinearOfSrgbByte(std::uint8_t byte) {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
      linear[i] = LinearOfSrgb(static_cast<double>(i) / 255.0);
    }
    return linear;
  }();
  return table[byte];
}

}  // namespace thunderhead::base
