// The drawn fields of a storm, resolved from the scene once for every technique and for the
// path-traced reference. They include the optics, particle size and detail of each field.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"
#include "physics/particle_size.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Returns true if the field is not zero everywhere, is visible in the scene and has a scale above
// 0.
bool IsDrawn(const Scene& scene, const volume::HydrometeorField& field);

struct DrawnField {
  std::size_t index = 0;  // into HydrometeorFields::fields
  physics::Hydrometeor hydrometeor{};
  // Extinction per concentration of the field, multiplied by the scene's scale. It varies by cell
  // if the model gives particle sizes.
  volume::MassExtinction mass_extinction;
  // One effective radius for the whole field, which selects the phase function. It has no value if
  // the file gives extinction instead of a mixing ratio.
  std::optional<float> radius_m;
  physics::SizeSource sizes{};  // where radius_m comes from
  float albedo = 1.0F;
  physics::PhaseFunction phase;  // canonical form from physics::PhaseOf
  glm::vec3 color{1.0F};         // white except in false colours
  // The detail that the technique draws. Its wavelength is above 0 if the field has detail.
  Detail detail;
  Detail asked_detail;  // the detail in the scene's settings, whether or not the technique shows it
};

// Returns the drawn fields in the order of `fields`.
std::vector<DrawnField> DrawnFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields);

// Returns the hydrometeors of the drawn fields.
std::vector<physics::Hydrometeor> HydrometeorsOf(const std::vector<DrawnField>& drawn);

}  // namespace thunderhead::scene
