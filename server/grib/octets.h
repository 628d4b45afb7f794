// Reads numbers from a section of a GRIB message. Octets are counted from 1, as in the manual on
// codes (WMO No. 306). Numbers are big-endian, and negative ones have a sign bit and a magnitude.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thunderhead::grib {

class Octets {
 public:
  explicit Octets(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t Count() const { return bytes_.size(); }

  // Returns the unsigned number of `count` octets that begins with octet `first`. Octets past the
  // end count as 0, so callers check Count() first.
  std::uint64_t Unsigned(std::size_t first, std::size_t count) const {
    std::uint64_t number = 0;
    for (std::size_t i = first - 1; i < first - 1 + count; ++i) {
      number = number << 8U | (i < bytes_.size() ? std::to_integer<std::uint64_t>(bytes_[i]) : 0U);
    }
    return number;
  }

  std::int64_t Signed(std::size_t first, std::size_t count) const {
    const std::uint64_t number = Unsigned(first, count);
    const std::uint64_t sign = std::uint64_t{1} << (8 * count - 1);
    const auto magnitude = static_cast<std::int64_t>(number & (sign - 1));
    return (number & sign) != 0 ? -magnitude : magnitude;
  }

  // Returns whether all bits of the number are set, which means that the number is missing.
  bool IsMissing(std::size_t first, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (Unsigned(first + i, 1) != 0xFF) return false;
    }
    return true;
  }

  // Returns value * 10^-scale, where octet `first` has the scale factor, and the `count` octets
  // after it have the value. Returns NaN if the value is missing. A missing scale factor counts as
  // 0.
  double Scaled(std::size_t first, std::size_t count) const {
    if (IsMissing(first + 1, count)) return std::nan("");
    const std::int64_t scale = IsMissing(first, 1) ? 0 : Signed(first, 1);
    return static_cast<double>(Signed(first + 1, count)) *
           std::pow(10.0, -static_cast<double>(scale));
  }

  std::span<const std::byte> Bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace thunderhead::grib
