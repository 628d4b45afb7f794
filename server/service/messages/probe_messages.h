// Rays and maps of a storm as messages.
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

// A storm's places: their heights, and where they are on Earth.
class StormPlaces {
 public:
  // Both must outlive it.
  StormPlaces(const storm_store::StormInfo& storm, const volume::HydrometeorFields& fields);

  // Nothing where the storm has no projection.
  std::optional<v1::EarthPlace> OnEarth(const glm::dvec2& place_m) const;
  // Of the middle; nothing for an idealised run.
  std::optional<v1::EarthPlace> Middle() const;
  // A place in the air.
  v1::RayPlace Of(const scene::StormRay& ray, double along_m) const;
  // A place where the ray meets the ground, whatever the height that the Earth's roundness gives
  // it.
  v1::RayPlace OnGround(const scene::StormRay& ray, double along_m) const;

  const volume::HydrometeorFields& fields() const { return fields_; }

 private:
  const storm_store::StormInfo& storm_;
  const volume::HydrometeorFields& fields_;
  std::optional<volume::MapProjection> projection_;
};

// All but the storm, its time and the scene's revision.
void ToMessage(const scene::ViewRay& ray, const scene::StormRay& storm_ray,
               const scene::RayProbe& probe, const StormPlaces& places,
               v1::ProbeRayResponse& message);

// All but the storm, its time and the fields that were added up.
void ToMessage(const volume::StormMap& map, const StormPlaces& places,
               v1::GetStormMapResponse& message);

}  // namespace thunderhead::service
