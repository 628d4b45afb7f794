// The geometry of half-angle slicing: planes perpendicular to the half vector between light and
// view, in the order in which sunlight meets them. It is pure geometry without GL. Sources: Kniss
// et al. 2003; Riley et al. 2003 (Vis), 4.4.1.
#pragma once

#include "glm/vec3.hpp"
#include "renderers/light_frame.h"
#include "scene/view.h"

namespace thunderhead::renderers {

// Equidistant parallel planes. The first plane is the nearest to the sun.
struct Slicing {
  glm::dvec3 normal{0.0, 0.0, 1.0};  // unit normal of the planes, on the sun's side
  int count = 0;
  double first_m = 0.0;  // distance of the first plane from the origin along the normal
  double spacing_m = 1.0;
  double light_path_m = 1.0;  // path length of a sun ray between two slices

  double Distance_m(int slice) const { return first_m - slice * spacing_m; }
};

// The order in which the rays of a view meet the slices, relative to the order in which sunlight
// meets them.
enum class SliceOrder { kAgainst, kAlong, kBoth };
SliceOrder OrderOf(const Slicing& slicing, const scene::View& view);

// Cuts `box` into `count` slices. `towards_eye` is the unit vector opposite to the view direction.
// If the eye is on the sun's side, the slices' normal lies halfway between `towards_sun` and
// `towards_eye`. Otherwise it lies halfway between `towards_sun` and the view direction, and the
// blend order is reversed.
Slicing SliceBox(const LocalBox& box, const glm::dvec3& towards_sun, const glm::dvec3& towards_eye,
                 int count);

}  // namespace thunderhead::renderers
