// Converts a scene and a storm's fields into the reference's input: medium, surroundings, camera.
// The same scene as the renderers draw, without their approximations: full-precision extinction,
// each field's own phase function, shadows on the ground. Knows no renderer.
#pragma once

#include <cstddef>
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
  std::shared_ptr<const SampledPhase> phase;  // replaces every field's own, if set
  // Delta scaling: for smaller scattering angles the phase function is held at its value at this
  // angle, and the light so cut off counts as not scattered; 0: off. The tables' diffraction peaks,
  // a thousand times brighter than the rest, cause most of the noise; the picture changes within
  // about this angle of the sun.
  double peak_cut_deg = 0.0;
  // Voxels along a cell's edge on which the light volume's turbulent detail is added
  // (scene/detailed_medium.h), with open sides and linear interpolation alone; 0: without detail.
  int detail_voxels_per_cell = 0;
  bool similar = false;  // MediumDescription::similar
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

// Memory that such a medium takes, without detail: each field's extinction, their sum and its
// bounds, and the same of the sum in the similar medium, if it has one.
std::size_t MediumBytes(const volume::HydrometeorFields& fields, bool similar);

// kShaded is a Lambertian ground lit by sun and sky through the medium; renderers draw its shadow
// from the sun. kUniform has the radiance that the same ground would have without any medium.
enum class GroundLight { kShaded, kUniform };

// Sun and sky of a scene, whatever its camera: tables that take some 20 ms.
struct SceneLight;
std::shared_ptr<const SceneLight> LightOf(const scene::Scene& scene,
                                          const volume::HydrometeorFields& fields);

// `light` is that of a scene that differs in its camera at most; null: it is made.
Surroundings SurroundingsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            GroundLight ground_light,
                            std::shared_ptr<const SceneLight> light = nullptr);

Camera CameraOf(const scene::Scene& scene, const volume::HydrometeorFields& fields);

}  // namespace thunderhead::reference
