// Closed-form integrals over the sphere of functions that are linear in the scattering angle
// between two angles. They are used to integrate, normalise and sample tables of phase functions.
#pragma once

#include <cmath>

namespace thunderhead::physics {

// A function that is linear in the angle from `start_rad` to `end_rad`, with its values at both
// ends.
struct LinearPiece {
  double start_rad;
  double end_rad;
  double start_value;
  double end_value;
};

// Returns the integral of value(t) sin(k t) over the piece, for k = 1 or 2. The formula is expanded
// about the middle of the piece. The textbook form suffers from cancellation on the steep pieces
// next to 0.
inline double IntegralOverSine(const LinearPiece& piece, double k) {
  const double middle = k * 0.5 * (piece.start_rad + piece.end_rad);
  const double half = k * 0.5 * (piece.end_rad - piece.start_rad);
  const double mean = 0.5 * (piece.start_value + piece.end_value);
  const double rise = 0.5 * (piece.end_value - piece.start_value);
  // sin h - h cos h suffers from cancellation when h is small, so its series is used there.
  const double bend = half < 0.02 ? half * half * half * (1.0 / 3.0 - half * half / 30.0)
                                  : std::sin(half) - half * std::cos(half);
  const double tilt = half > 0.0 ? rise / half * bend : 0.0;
  return 2.0 * (mean * std::sin(middle) * std::sin(half) + tilt * std::cos(middle)) / k;
}

// Returns this piece's part of a phase function's mean over the sphere, 1/2 integral P sin.
inline double ShareOf(const LinearPiece& piece) { return 0.5 * IntegralOverSine(piece, 1.0); }

// Returns this piece's part of the mean cosine, 1/2 integral P cos sin.
inline double CosineOf(const LinearPiece& piece) { return 0.25 * IntegralOverSine(piece, 2.0); }

}  // namespace thunderhead::physics
