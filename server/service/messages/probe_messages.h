// Converts rays and maps of a storm to messages.
#pragma once

#include <optional>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/ray_probe.h"
#include "scene/storm_ray.h"
#include "scene/view.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/probe.pb.h"
#include "volume/hydrometeor_fields.h"
#include "volume/map_projection.h"
#include "volume/storm_map.h"

namespace thunderhead::service {

// Computes the heights and the geographic positions of places in a storm.
class StormPlaces {
 public:
  // Computes places at time `time_index` of the storm, whose fields are `fields`. `fields` must
  // outlive this object.
  StormPlaces(const storm_store::StormInfo& storm, int time_index,
              const volume::HydrometeorFields& fields);

  // Returns the place on Earth. Returns nothing if the storm has no projection, or the projection
  // does not cover the place.
  std::optional<v1::EarthPlace> OnEarth(const glm::dvec2& place_m) const;
  // Returns the middle of the domain on Earth, or nothing for an idealised run.
  std::optional<v1::EarthPlace> Middle() const;
  // Returns the table of places around the domain, or nothing if the storm has no projection.
  std::optional<v1::PlaceTable> Table() const;
  // Returns the point of the ray at the distance `along_m` from its origin.
  v1::RayPlace Of(const scene::StormRay& ray, double along_m) const;
  // Does the same for the point where the ray meets the ground. Its height is that of the terrain,
  // unaffected by the Earth's curvature.
  v1::RayPlace OnGround(const scene::StormRay& ray, double along_m) const;

  const volume::HydrometeorFields& fields() const { return fields_; }

 private:
  std::optional<volume::EarthPlace> middle_;
  const volume::HydrometeorFields& fields_;
  std::optional<volume::MapProjection> projection_;
};

// Sets all fields except the storm, its time, the scene's revision and first_cloud_depth.
void ToMessage(const scene::ViewRay& ray, const scene::StormRay& storm_ray,
               const scene::RayProbe& probe, const StormPlaces& places,
               v1::ProbeRayResponse& message);

// Sets all members of the message except `storm_id`, `time_index`, `fields`, `units`, `projection`
// and `places`.
void ToMessage(const volume::StormMap& map, const StormPlaces& places,
               v1::GetStormMapResponse& message);

}  // namespace thunderhead::service
