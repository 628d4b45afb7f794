// The box of a domain in which the storm is visible, for a camera to frame. A scene chooses only
// the source of the particles' sizes; the other optics are the defaults. This code does not depend
// on scenes.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct WorldBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// Returns the box that leaves 0.1 % of the storm's extinction beyond each of its faces, or the
// whole domain if there is no condensate.
WorldBox VisibleBox(const HydrometeorFields& fields,
                    physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
