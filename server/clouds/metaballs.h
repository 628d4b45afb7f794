// The representation of a cloud by metaballs, which have centres, sizes and weights (P. Man,
// "Generating and Real-Time Rendering of Clouds", eq. 11-19). The cloud's field is the sum of all
// balls. This file also declares the text format of such clouds. This code does not depend on
// storms or rendering.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"

namespace thunderhead::clouds {

// The basis function of one ball.
//
// kGaussian is exp(-r^2 / s^2) with s = u sigma / 2, cut off at a distance r of 3 s. For u = 2 it
// equals eq. 15.
//
// kWyvill is the field of eq. 12 with radius R = u sigma (eq. 16), without its constant k. It is 1
// at the centre, and 0 from the distance R on.
enum class Basis { kGaussian, kWyvill };

std::string_view NameOf(Basis basis);

struct Metaball {
  glm::dvec3 centre_m{0.0};
  double sigma_m = 1.0;  // size of the ball: the root mean square distance from its centre to the
                         // points that it represents (clouds/clustering.h)
  double weight = 0.0;   // v of eq. 17: the ball's value at its centre

  bool operator==(const Metaball&) const = default;
};

struct MetaballCloud {
  std::string quantity = "extinction";  // quantity of the field: "extinction" or the name of a
                                        // hydrometeor
  std::string units = "m-1";            // unit of the weights
  Basis basis = Basis::kGaussian;
  double overlap = 2.0;   // u of eq. 16
  glm::dvec3 low_m{0.0};  // low corner, in world coordinates, of the box that the balls approximate
  glm::dvec3 high_m{0.0};
  std::vector<Metaball> balls;

  bool operator==(const MetaballCloud&) const = default;
};

// Returns the distance from a ball's centre beyond which its value is 0.
double Reach_m(Basis basis, double overlap, double sigma_m);

// Returns the value of a ball of weight 1 at `distance_m` from its centre.
double BasisValue(Basis basis, double overlap, double sigma_m, double distance_m);

// Returns the cloud in its text format, without loss of precision.
std::string ToText(const MetaballCloud& cloud);

absl::Status SaveBalls(const MetaballCloud& cloud, const std::string& path);

}  // namespace thunderhead::clouds
