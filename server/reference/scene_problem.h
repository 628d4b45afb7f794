// Converts a scene and a storm's fields into the input of the path tracer: medium, surroundings and
// camera. They describe the scene that the renderers draw, without the renderers' approximations.
// Extinction has full precision, and the ground has shadows. This code does not use a renderer.
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
  // The renderers draw linear extinction. With constant cells, the medium fills exactly the boxes
  // of the file's cells.
  Interpolation interpolation = Interpolation::kLinear;
  std::shared_ptr<const SampledPhase> phase;  // if set, replaces the phase function of every field
  // Angle of delta scaling in degrees; 0 means no scaling. At smaller scattering angles, the phase
  // function is replaced by its value at this angle. The light that this cuts off counts as not
  // scattered. The tables' diffraction peaks are a thousand times brighter than the rest and cause
  // most of the noise. The cut changes the picture only within about this angle of the sun.
  double peak_cut_deg = 0.0;
  // Number of voxels along a cell's edge for the turbulent detail of the light volume
  // (scene/detailed_medium.h). 0 means no detail. Detail needs open sides and linear interpolation.
  int detail_voxels_per_cell = 0;
  bool similar = false;  // MediumDescription::similar
};

// Creates the medium of the scene's visible fields. With open sides, its box is the smallest box
// that holds all condensate, with a border as in volume/extinction.h. With periodic sides, the box
// is the whole domain. A storm without condensate gives an empty medium. False colours multiply
// albedos. If the scene's technique does not show each field's own phase function, every field has
// that of cloud water.
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       const MediumOptions& options);
absl::StatusOr<std::shared_ptr<const Medium>> MediumOf(const scene::Scene& scene,
                                                       const volume::HydrometeorFields& fields,
                                                       Sides sides);

// Returns the memory in bytes of a medium without turbulent detail. The medium holds each field's
// extinction, their sum and its upper bounds. If `similar` is true, it holds another sum with its
// bounds.
std::size_t MediumBytes(const volume::HydrometeorFields& fields, bool similar);

// How the ground is lit. With kShaded, the light of sun and sky passes through the medium to a
// Lambertian ground, so the ground has the shadow that renderers draw. With kUniform, the ground
// has the radiance that it would have without any medium.
enum class GroundLight { kShaded, kUniform };

// Sun and sky of a scene, independent of its camera. Computing their tables takes about 20 ms.
struct SceneLight;
std::shared_ptr<const SceneLight> LightOf(const scene::Scene& scene,
                                          const volume::HydrometeorFields& fields);

// Creates the surroundings. `light` is the light of this scene, or of a scene that differs only in
// its camera. If it is null, it is computed.
Surroundings SurroundingsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                            GroundLight ground_light,
                            std::shared_ptr<const SceneLight> light = nullptr);

Camera CameraOf(const scene::Scene& scene, const volume::HydrometeorFields& fields);

}  // namespace thunderhead::reference
