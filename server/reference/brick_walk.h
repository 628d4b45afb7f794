// Traverses the lattice of a medium's bricks along a ray (Amanatides and Woo 1987): the segments of
// constant majorant, in order. Knows no light.
#pragma once

#include <limits>

#include "glm/vec3.hpp"
#include "reference/medium.h"

namespace thunderhead::reference {

// Length of a ray that nothing ends.
inline constexpr double kEndless_m = std::numeric_limits<double>::infinity();

struct Ray {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};  // unit

  glm::dvec3 At(double distance_m) const { return origin_m + distance_m * direction; }
};

// The part of a ray, in metres from its origin, that lies in a box; empty if end <= begin.
struct RayInterval {
  double begin_m = 0.0;
  double end_m = 0.0;
};

// The part of `ray` up to `limit_m` in the medium's box; in its range of heights if it is periodic.
RayInterval Clip(const Medium& medium, const Ray& ray, double limit_m);

// A segment of a ray in one brick that is not empty.
struct Stretch {
  double begin_m = 0.0;
  double end_m = 0.0;
  double majorant_per_m = 0.0;
  glm::ivec3 brick{0};  // x and y continue beyond the lattice if periodic
};

class BrickWalk {
 public:
  // `medium` must outlive the walk.
  BrickWalk(const Medium& medium, const Ray& ray, double limit_m, Optics optics = Optics::kExact);

  // Finds the next segment in a brick that is not empty; false at the end of the ray.
  bool Next(Stretch* stretch);

 private:
  void Enter(int axis);
  void SkipLayer();
  glm::ivec3 WrappedBrick() const;

  const Medium& medium_;
  Optics optics_;
  Ray ray_;
  // One over the ray's direction; infinite along axes that it does not move along.
  glm::dvec3 inverse_;
  double at_m_;
  double end_m_;
  glm::ivec3 brick_{0};  // x and y continue beyond the lattice if periodic
  glm::ivec3 step_{0};
  glm::dvec3 next_m_{0.0};   // distance at which the ray leaves the brick along each axis
  glm::dvec3 delta_m_{0.0};  // distance along the ray between two faces of each axis
};

}  // namespace thunderhead::reference
