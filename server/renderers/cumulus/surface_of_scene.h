// The surface of ellipsoids that the cumulus renderer draws for a scene. It follows the storm's
// cloud water and ice, or is generated from a seed and fills the storm's box. This code does not
// use GL.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cumulus_surface.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

struct DrawnSurface {
  clouds::CumulusSurface surface;
  std::vector<physics::Hydrometeor> fields;  // the storm's fields from which the surface was made
};

absl::StatusOr<DrawnSurface> SurfaceOf(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields);

// Returns the parts of the storm that the surface does not show.
std::vector<scene::NotShown> NotShownByCumulus(const scene::Scene& scene,
                                               const volume::HydrometeorFields& fields);

}  // namespace thunderhead::renderers
