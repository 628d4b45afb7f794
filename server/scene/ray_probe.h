// Numbers along a ray through a storm, for people: the distance to the first cloud, the amount of
// each field and the place of its maximum. Every value is linear between cell centres
// (ray_pieces.h). This code does not use GL.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "scene/storm_ray.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

struct ProbeSettings {
  int samples = 0;                 // number of field samples along the part in the domain
  double first_cloud_depth = 0.1;  // optical depth that counts as cloud; above 0
};

// Values of one field along the ray. `values` and `maximum` are in the unit of volume::QuantityOf.
struct FieldOnRay {
  std::size_t index = 0;      // into HydrometeorFields::fields
  std::vector<float> values;  // at the samples; empty if the field is zero everywhere
  double maximum = 0.0;
  // Distance along the ray; no value if the field is zero along the ray.
  std::optional<double> maximum_m;
  double maximum_kg_per_m3 = 0.0;  // mass at the maximum; 0 for a field of extinction
  double path_kg_per_m2 = 0.0;     // mass path; 0 for a field of extinction
  double optical_depth = 0.0;      // of the field as the scene draws it
};

struct RayProbe {
  std::optional<double> first_cloud_m;
  std::optional<double> depth_one_m;
  std::vector<double> distances_m;  // of the samples; empty if the ray misses the domain
  std::vector<float> extinctions_per_m;
  std::vector<FieldOnRay> fields;  // all fields of the storm
};

// Probes the fields along `ray`, which must belong to this scene and these fields.
RayProbe ProbeRay(const Scene& scene, const volume::HydrometeorFields& fields, const StormRay& ray,
                  const ProbeSettings& settings);

}  // namespace thunderhead::scene
