// Where in its domain a storm is to be seen: what a camera should frame. Uses the default optics;
// knows no scene.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct WorldBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The box that leaves out 0.1 % of the storm's extinction beyond each of its faces; the whole
// domain if the storm holds no condensate.
WorldBox VisibleBox(const HydrometeorFields& fields);

}  // namespace thunderhead::volume
