// Conversion between floats and IEEE half-precision floats, which textures store.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace thunderhead::base {

inline constexpr float kLargestHalf = 65504.0F;

// Returns the half float nearest to `value`. A magnitude that is too large becomes the largest half
// of the same sign.
inline std::uint16_t HalfFromFloat(float value) {
  constexpr std::uint16_t kNotANumber = 0x7E00;
  if (std::isnan(value)) return kNotANumber;
  const float size = std::min(std::abs(value), kLargestHalf);
  const auto bits = std::bit_cast<std::uint32_t>(size);
  // For values that become subnormal halves, adding 0.5 aligns the half's smallest step with the
  // float's last bit. The addition therefore rounds to the nearest half.
  const std::uint32_t subnormal = std::bit_cast<std::uint32_t>(size + 0.5F) - 0x3F000000U;
  const std::uint32_t normal = (bits + 0xFFFU + ((bits >> 13U) & 1U) - 0x38000000U) >> 13U;
  const std::uint32_t sign = (std::bit_cast<std::uint32_t>(value) >> 16U) & 0x8000U;
  return static_cast<std::uint16_t>((bits < 0x38800000U ? subnormal : normal) | sign);
}

// Returns the value of a half float that is a number and not negative. Infinity becomes 65536.
inline float FloatFromHalf(std::uint16_t half) {
  // The multiplication converts the exponent from the bias of a half to that of a float. It is also
  // right for subnormal halves.
  return std::bit_cast<float>(static_cast<std::uint32_t>(half) << 13U) * 0x1p112F;
}

}  // namespace thunderhead::base
