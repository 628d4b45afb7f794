// The box of a domain in which the storm is visible, for a camera to frame. Particle radii come
// from the size source that the scene chooses; all other optical properties are the defaults. This
// code does not depend on scenes.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct WorldBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// Returns the smallest box of whole cells for which at most 0.1 % of the storm's total extinction
// lies beyond each face. Returns the whole domain if there is no condensate.
WorldBox VisibleBox(const HydrometeorFields& fields,
                    physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
