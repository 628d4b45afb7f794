// Values along a ray through a storm for display to a viewer: the distance to the first cloud, and
// the amount of each field with the place of its maximum. Every value is linear between cell
// centres (ray_pieces.h). This code does not use GL.
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
  int samples = 0;  // number of field samples along the part of the ray in the domain
  // Optical depth from which cloud counts as the first cloud. It must be above 0.
  double first_cloud_depth = 0.1;
};

// Values of one field along the ray. `values` and `maximum` are in the unit of volume::QuantityOf.
struct FieldOnRay {
  std::size_t index = 0;  // index into HydrometeorFields::fields
  // Values at RayProbe::distances_m. Empty if the field is zero everywhere.
  std::vector<float> values;
  double maximum = 0.0;
  // Distance along the ray to the maximum. It has no value if the field is zero along the ray.
  std::optional<double> maximum_m;
  // Mass density at the maximum; 0 for a field that the file gives as extinction.
  double maximum_kg_per_m3 = 0.0;
  // Mass path along the ray; 0 for a field that the file gives as extinction.
  double path_kg_per_m2 = 0.0;
  double optical_depth = 0.0;  // optical depth of the field as the scene draws it
};

struct RayProbe {
  // Distances at which the optical depth reaches ProbeSettings::first_cloud_depth and 1, if it
  // reaches them.
  std::optional<double> first_cloud_m;
  std::optional<double> depth_one_m;
  // Distances of the samples from the eye; empty if the ray misses the domain.
  std::vector<double> distances_m;
  // Extinction of all drawn fields at each of `distances_m`.
  std::vector<float> extinctions_per_m;
  std::vector<FieldOnRay> fields;  // one entry for each field of the storm
};

// Probes the fields along `ray`, which must belong to this scene and these fields.
RayProbe ProbeRay(const Scene& scene, const volume::HydrometeorFields& fields, const StormRay& ray,
                  const ProbeSettings& settings);

}  // namespace thunderhead::scene
