// Converts a scene and a storm's fields into the reference's input: medium, surroundings and
// camera. It is the scene that the renderers draw, but without their approximations. Extinction has
// full precision, each field has its own phase function, and the ground has shadows. This code does
// not use a renderer.
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
  // Constant cells fill the file's own boxes. The renderers draw linear ones.
  Interpolation interpolation = Interpolation::kLinear;
  std::shared_ptr<const SampledPhase> phase;  // if set, replaces every field's own
  // Angle of delta scaling. For smaller scattering angles, the phase function is replaced by its
  // value at this angle. The light cut off in this way counts as not scattered. 0: off. The tables'
  // diffraction peaks are a thousand times brighter than the rest and cause most of the noise. The
  // cut changes the picture only within about this angle of the sun.
  double peak_cut_deg = 0.0;
  // Voxels along a cell's edge for the light volume's turbulent detail (scene/detailed_medium.h).
  // Detail needs open sides and linear interpolation. 0: without detail.
  int detail_voxels_per_cell = 0;
  bool similar = false;  // MediumDescription::similar
};

// Creates the medium of the scene's visible fields. With open sides, the box is the smallest that
// holds all condensate, with a border as in volume/extinction.h. With periodic sides, it is the
// whole domain. A storm without condensate gives an empty medium. False colours multiply albedos.
// The uniform-phase modes give every field the phase function of cloud water.
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       const MediumOptions& options);
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       Sides sides);

// Returns the memory of such a medium without detail. It holds each field's extinction, their sum
// and its bounds. A similar medium adds another sum with its bounds.
std::size_t MediumBytes(const volume::HydrometeorFields& fields, bool similar);

// How the ground is lit. With kShaded, sun and sky light a Lambertian ground through the medium, so
// that it has the shadow that renderers draw. With kUniform, the ground has the radiance that it
// would have without any medium.
enum class GroundLight { kShaded, kUniform };

// Sun and sky of a scene, independent of its camera. Computing their tables takes about 20 ms.
struct SceneLight;
std::shared_ptr<const SceneLight> LightOf(const scene::Scene& scene,
                                          const volume::HydrometeorFields& fields);

// Creates the surroundings. `light` must be that of a scene that differs at most in its camera. If
// it is null, it is computed.
Surroundings SurroundingsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            GroundLight ground_light,
                            std::shared_ptr<const SceneLight> light = nullptr);

Camera CameraOf(const scene::Scene& scene, const volume::HydrometeorFields& fields);

}  // namespace thunderhead::reference
