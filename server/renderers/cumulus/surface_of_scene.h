// The surface that the cumulus renderer draws of a scene: of the storm's cloud water and ice, or
// made from a seed in the storm's place. Knows no GL.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cumulus_surface.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

struct DrawnSurface {
  clouds::CumulusSurface surface;
  std::vector<physics::Hydrometeor> fields;  // that it was made of
};

absl::StatusOr<DrawnSurface> SurfaceOf(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields);

// Parts of the scene and its storm that the cumulus renderer leaves out, a few words each.
std::vector<std::string> NotShownByCumulus(const scene::Scene& scene,
                                           const volume::HydrometeorFields& fields);

}  // namespace thunderhead::renderers
