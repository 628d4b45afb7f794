// The surface that the cumulus renderer draws of a scene: of the storm's cloud water and ice, or
// made from a seed in the storm's place. Knows no GL.
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
  std::vector<physics::Hydrometeor> fields;  // that it was made of
};

absl::StatusOr<DrawnSurface> SurfaceOf(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields);

// The parts of the storm that the surface leaves out.
std::vector<scene::NotShown> NotShownByCumulus(const scene::Scene& scene,
                                               const volume::HydrometeorFields& fields);

}  // namespace thunderhead::renderers
