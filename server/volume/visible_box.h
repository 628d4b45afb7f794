// The box of a domain in which the storm is visible, for a camera to frame. Of the optics only the
// particles' sizes are a scene's; knows no scene.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct WorldBox {
  glm::dvec3 low_m{0.0};
  glm::dvec3 high_m{0.0};
};

// The box with 0.1 % of the storm's extinction beyond each of its faces; the whole domain if there
// is no condensate.
WorldBox VisibleBox(const HydrometeorFields& fields,
                    physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
