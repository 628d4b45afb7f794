// The parameters of a generated cloud: grid, noise, ellipsoids and amount of water. Equations are
// those of P. Man, "Generating and Real-Time Rendering of Clouds" (clouds/generator.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clouds/noise.h"
#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "volume/grid.h"

namespace thunderhead::clouds {

// An ellipsoid that is rotated about x, then y, then z, through its centre. World coordinates are
// in metres: x and y from the middle of the domain, z from sea level.
struct Ellipsoid {
  glm::dvec3 centre_m{0.0};
  glm::dvec3 radii_m{1.0};
  glm::dvec3 rotation_deg{0.0};
};

// Returns the rotation matrix for Ellipsoid::rotation_deg. Its columns are the unit vectors of the
// rotated axes.
glm::dmat3 AxesOf(const glm::dvec3& rotation_deg);

struct CloudShape {
  volume::RegularGrid grid;
  NoiseParameters noise;
  double feature_m = 400.0;           // size of the coarsest octave's lattice cells
  double threshold = 0.1;             // t of eq. 10: a density below this counts as zero
  double dynamics = 1.0;              // d of eq. 10: factor of all densities
  double water_kg_per_m3 = 2e-3;      // amount of water at density 1
  std::optional<double> base_m;       // height of the flat base; the cloud is cut off below it
  std::vector<Ellipsoid> ellipsoids;  // the cloud is their union
};

// The quadric Q of eq. 8 for one ellipsoid. Its value is 1 at the ellipsoid's centre, 0 on its
// surface and negative outside. Q at a point p is 1 - (p - c)^T M (p - c), where c is the centre.
class Quadric {
 public:
  explicit Quadric(const Ellipsoid& ellipsoid);

  double Value(const glm::dvec3& point_m) const {
    const glm::dvec3 from_centre = point_m - centre_m_;
    const glm::dvec3 m = matrix_ * from_centre;
    return 1.0 - (from_centre.x * m.x + from_centre.y * m.y + from_centre.z * m.z);
  }

  // Returns half the size of the ellipsoid's axis-aligned bounding box.
  const glm::dvec3& HalfExtent_m() const { return half_extent_m_; }
  const glm::dvec3& Centre_m() const { return centre_m_; }

 private:
  glm::dvec3 centre_m_;
  glm::dmat3 matrix_{0.0};
  glm::dvec3 half_extent_m_{0.0};
};

}  // namespace thunderhead::clouds
