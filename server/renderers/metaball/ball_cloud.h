// A storm as metaballs for drawing. They are the fitted balls (clouds/metaballs.h) with Wyvill's
// field function, and the share of each group of fields in a ball's extinction. Equations are those
// of P. Man, "Generating and Real-Time Rendering of Clouds". The types are plain values and do not
// use GL.
#pragma once

#include <array>
#include <vector>

#include "glm/vec3.hpp"
#include "volume/extinction.h"

namespace thunderhead::renderers {

struct Ball {
  glm::dvec3 middle_m{0.0};
  double radius_m = 1.0;          // R of eq. 16
  double extinction_per_m = 0.0;  // extinction at the ball's centre; at least 0
  // Share of each of the medium's groups in the ball's extinction. The shares add up to 1, or are 0
  // if the storm has no extinction in the ball.
  std::array<float, volume::kMaxChannels> shares{1.0F};
};

struct BallCloud {
  std::vector<Ball> balls;
  // The fit's root mean square error, relative to the root mean square of the field (eq. 20).
  double relative_error = 0.0;
};

// The bounding box of all balls. Without balls it is empty (low_m above high_m).
struct BallBox {
  glm::dvec3 low_m{1.0};
  glm::dvec3 high_m{-1.0};

  bool Empty() const { return low_m.x > high_m.x; }
  glm::dvec3 Middle_m() const { return 0.5 * (low_m + high_m); }
  glm::dvec3 HalfExtent_m() const { return 0.5 * (high_m - low_m); }
};

BallBox BoxOf(const std::vector<Ball>& balls);

}  // namespace thunderhead::renderers
