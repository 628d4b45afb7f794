// A storm's fields as a scene shows them, resolved once for every technique and the reference:
// which are drawn, and the optics, particle size and detail of each.
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

// True if the field holds anything, is visible and is not scaled away.
bool IsDrawn(const Scene& scene, const volume::HydrometeorField& field);

struct DrawnField {
  std::size_t index = 0;  // into HydrometeorFields::fields
  physics::Hydrometeor hydrometeor{};
  // Of the mixing ratio in the file: the scene's scale is in it. By cell where the sizes are the
  // model's.
  volume::MassExtinction mass_extinction;
  // Effective, of all the field's particles; none where the file gives extinction.
  std::optional<float> radius_m;
  physics::SizeSource sizes{};  // where radius_m comes from
  float albedo = 1.0F;
  physics::PhaseFunction phase;  // by physics::PhaseOf
  glm::vec3 color{1.0F};         // white but in false colours
  Detail detail;                 // as it is drawn, with a wavelength if any
  Detail asked_detail;           // of the scene, whether the technique shows it or not
};

// In the order of `fields`.
std::vector<DrawnField> DrawnFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields);

// The hydrometeors among them.
std::vector<physics::Hydrometeor> HydrometeorsOf(const std::vector<DrawnField>& drawn);

}  // namespace thunderhead::scene
