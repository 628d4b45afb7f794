// Numbers along a ray through a storm, for people: where cloud begins, how much there is of each
// field and where there is most of it. Every value is linear between cells' middles
// (ray_pieces.h). Without GL.
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
  int samples = 0;                 // of fields, along the part in the domain
  double first_cloud_depth = 0.1;  // above 0
};

// One field along the ray. `values` and `maximum` are in the unit of volume::QuantityOf.
struct FieldOnRay {
  std::size_t index = 0;      // into HydrometeorFields::fields
  std::vector<float> values;  // at the samples; empty if the field is zero everywhere
  double maximum = 0.0;
  std::optional<double> maximum_m;  // along the ray; nothing if there is nothing
  double maximum_kg_per_m3 = 0.0;   // the mass there; 0 of extinction
  double path_kg_per_m2 = 0.0;      // 0 of extinction
  double optical_depth = 0.0;       // as the scene draws it
};

struct RayProbe {
  std::optional<double> first_cloud_m;
  std::optional<double> depth_one_m;
  std::vector<double> distances_m;  // of the samples; none where the ray misses the domain
  std::vector<float> extinctions_per_m;
  std::vector<FieldOnRay> fields;  // all of the storm's
};

// `ray` is of this scene and these fields.
RayProbe ProbeRay(const Scene& scene, const volume::HydrometeorFields& fields, const StormRay& ray,
                  const ProbeSettings& settings);

}  // namespace thunderhead::scene
