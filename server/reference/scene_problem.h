// From a scene and a storm's fields to what the reference computes: medium, surroundings, camera.
// The same scene that the renderers draw, without their approximations: full-precision extinction,
// each field's own phase function, a ground that clouds shade. Knows no renderer.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "reference/camera.h"
#include "reference/medium.h"
#include "reference/surroundings.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::reference {

struct MediumOptions {
  Sides sides = Sides::kOpen;
  // Constant cells fill the file's own boxes; linear ones are what the renderers draw.
  Interpolation interpolation = Interpolation::kLinear;
  std::shared_ptr<const SampledPhase> phase;  // in place of every field's own, if given
  // Light that a field scatters within this angle of straight on counts as not scattered (delta
  // scaling), but for what a function held at its value there leaves. 0 changes nothing. The
  // tables' diffraction peaks, a thousand times brighter than the rest, are what makes pictures
  // noisy; what changes is seen within about this angle of the sun.
  double peak_cut_deg = 0.0;
};

// The scene's visible fields. With open sides the box is the smallest that holds all condensate,
// bordered as in volume/extinction.h; with periodic ones, the whole domain. A storm without
// condensate gives an empty medium. False colours multiply albedos, the uniform-phase modes give
// every field cloud water's phase function.
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       const MediumOptions& options);
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       Sides sides);

// kShaded is a Lambertian ground lit by sun and sky through the medium; renderers draw its shadow
// from the sun. kUniform has the radiance that the same ground would have without any medium.
enum class GroundLight { kShaded, kUniform };

Surroundings SurroundingsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            GroundLight ground_light);

Camera CameraOf(const scene::Scene& scene, const volume::HydrometeorFields& fields);

}  // namespace thunderhead::reference
