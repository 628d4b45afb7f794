// Sine, cosine and cube root, computed with the four basic operations and with functions that are
// exact, such as std::remainder. In contrast to the C library's functions, they return the same
// bits on every machine with IEEE doubles. Their error is at most 1e-15.
#pragma once

#include <cmath>
#include <numbers>

namespace thunderhead::clouds {

// Returns the sine of `degrees`, any finite number.
inline double SineOfDegrees(double degrees) {
  // std::remainder is exact. It reduces the angle to the range from -180 to 180 degrees. The next
  // lines reduce it to the range from -90 to 90 degrees.
  double rest = std::remainder(degrees, 360.0);
  if (rest > 90.0) rest = 180.0 - rest;
  if (rest < -90.0) rest = -180.0 - rest;
  const double x = rest * (std::numbers::pi / 180.0);
  const double square = x * x;
  double term = x;
  double sum = x;
  for (int i = 1; i <= 13; ++i) {
    term *= -square / ((2.0 * i) * (2.0 * i + 1.0));
    sum += term;
  }
  return sum;
}

inline double CosineOfDegrees(double degrees) { return SineOfDegrees(degrees + 90.0); }

// Returns the cube root of a finite number that is not below 0, by Newton's method.
inline double CubeRoot(double x) {
  if (x <= 0.0) return 0.0;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  for (; exponent % 3 != 0; ++exponent) mantissa *= 0.5;
  double root = 0.7;  // the mantissa is from 1/8 to 1
  for (int i = 0; i < 8; ++i) root = (2.0 * root + mantissa / (root * root)) / 3.0;
  return std::ldexp(root, exponent / 3);
}

}  // namespace thunderhead::clouds
