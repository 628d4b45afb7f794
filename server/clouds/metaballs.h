// A cloud as metaballs: centres, sizes and amounts (Man, eq. 11-19), their sum as a field, and
// their text format. This code does not depend on storms or rendering.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"

namespace thunderhead::clouds {

// The basis function of one ball.
//
// kGaussian is exp(-r2 / s2) with s = u sigma / 2, cut off at 3 s. It is eq. 15 for the printed u =
// 2.
//
// kWyvill is the field of eq. 12 with radius R = u sigma (eq. 16), without its constant k. It is 1
// in the middle, and 0 from R on.
enum class Basis { kGaussian, kWyvill };

std::string_view NameOf(Basis basis);

struct Metaball {
  glm::dvec3 centre_m{0.0};
  double sigma_m = 1.0;  // root mean square distance of its cluster, eq. 23
  double weight = 0.0;   // v of eq. 17: the value in its middle

  bool operator==(const Metaball&) const = default;
};

struct MetaballCloud {
  std::string quantity = "extinction";  // or a hydrometeor's name
  std::string units = "m-1";            // unit of the weights
  Basis basis = Basis::kGaussian;
  double overlap = 2.0;   // u of eq. 16
  glm::dvec3 low_m{0.0};  // the box that was approximated; world coordinates
  glm::dvec3 high_m{0.0};
  std::vector<Metaball> balls;

  bool operator==(const MetaballCloud&) const = default;
};

// Returns the distance from which a ball's value is 0.
double Reach_m(Basis basis, double overlap, double sigma_m);

// Returns the value of a ball of weight 1 at `distance_m` from its centre.
double BasisValue(Basis basis, double overlap, double sigma_m, double distance_m);

// Returns the cloud as text, without loss.
std::string ToText(const MetaballCloud& cloud);

absl::Status SaveBalls(const MetaballCloud& cloud, const std::string& path);

}  // namespace thunderhead::clouds
