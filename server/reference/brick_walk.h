// Traverses the lattice of a medium's bricks along a ray (Amanatides and Woo 1987). It yields in
// order the segments of the ray with a constant majorant (upper bound of the extinction). This code
// does not depend on light sources.
#pragma once

#include <limits>

#include "glm/vec3.hpp"
#include "reference/medium.h"

namespace thunderhead::reference {

// Length of an unlimited ray.
inline constexpr double kEndless_m = std::numeric_limits<double>::infinity();

struct Ray {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};  // unit vector

  glm::dvec3 At(double distance_m) const { return origin_m + distance_m * direction; }
};

// The part of a ray that lies in a box, in metres from the ray's origin. It is empty if end <=
// begin.
struct RayInterval {
  double begin_m = 0.0;
  double end_m = 0.0;
};

// Returns the part of `ray` up to `limit_m` that lies in the medium's box. A periodic medium has no
// sides, so only the box's range of heights limits the ray.
RayInterval Clip(const Medium& medium, const Ray& ray, double limit_m);

// A segment of a ray in a non-empty brick.
struct Stretch {
  double begin_m = 0.0;
  double end_m = 0.0;
  double majorant_per_m = 0.0;
  // Index in the lattice. If the medium is periodic, x and y continue beyond the lattice.
  glm::ivec3 brick{0};
};

class BrickWalk {
 public:
  // `medium` must outlive the walk.
  BrickWalk(const Medium& medium, const Ray& ray, double limit_m, Optics optics = Optics::kExact);

  // Finds the next segment in a non-empty brick. Returns false at the end of the ray.
  bool Next(Stretch* stretch);

 private:
  void Enter(int axis);
  void SkipLayer();
  glm::ivec3 WrappedBrick() const;

  const Medium& medium_;
  Optics optics_;
  Ray ray_;
  // One over the ray's direction. It is infinite along axes perpendicular to the ray.
  glm::dvec3 inverse_;
  double at_m_;
  double end_m_;
  // Index in the lattice. If the medium is periodic, x and y continue beyond the lattice.
  glm::ivec3 brick_{0};
  glm::ivec3 step_{0};
  glm::dvec3 next_m_{0.0};   // distance at which the ray leaves the brick along each axis
  glm::dvec3 delta_m_{0.0};  // distance along the ray between two faces of each axis
};

}  // namespace thunderhead::reference
