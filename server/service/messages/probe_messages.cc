#include "service/messages/probe_messages.h"

#include <algorithm>
#include <string>

#include "base/utf8.h"
#include "glm/trigonometric.hpp"
#include "service/messages/camera_messages.h"
#include "service/messages/scene_messages.h"
#include "volume/field_values.h"
#include "volume/place_table.h"
#include "volume/terrain.h"

namespace thunderhead::service {
namespace {

// The table of places has kNodes nodes along each side. From the middle of the domain, it reaches
// kReach times the length of the domain's longer side, but not farther than kFarthest_deg. It then
// contains the page's map, which also shows a camera outside the domain. For a domain of 500 km,
// coordinates between nodes are accurate to 20 m.
constexpr int kNodes = 65;
constexpr double kReach = 1.9;
constexpr double kFarthest_deg = 175.0;
constexpr double kEarth_m = 6.371e6;

v1::EarthPlace PlaceMessage(const volume::EarthPlace& place) {
  v1::EarthPlace message;
  message.set_latitude_deg(place.latitude_deg);
  message.set_longitude_deg(place.longitude_deg);
  return message;
}

// Sets the hydrometeor, variable and units of a field.
template <typename Message>
void Name(const volume::HydrometeorFields& fields, std::size_t index, Message& message) {
  const volume::HydrometeorField& field = fields.fields[index];
  message.set_hydrometeor(ToMessage(field.hydrometeor));
  message.set_variable(base::Printable(field.variable));
  message.set_units(std::string(volume::UnitOf(volume::QuantityOf(fields, field))));
}

v1::ProbeRayResponse::Seen SeenMessage(scene::Seen seen) {
  switch (seen) {
    case scene::Seen::kCloud:
      return v1::ProbeRayResponse::SEEN_CLOUD;
    case scene::Seen::kGround:
      return v1::ProbeRayResponse::SEEN_GROUND;
    case scene::Seen::kSky:
      break;
  }
  return v1::ProbeRayResponse::SEEN_SKY;
}

void SetFieldAlongRay(const scene::FieldOnRay& field, const scene::StormRay& ray,
                      const StormPlaces& places, v1::FieldAlongRay& message) {
  Name(places.fields(), field.index, message);
  message.mutable_values()->Assign(field.values.begin(), field.values.end());
  message.set_maximum(static_cast<float>(field.maximum));
  if (field.maximum_m.has_value()) {
    *message.mutable_maximum_place() = places.Of(ray, *field.maximum_m);
  }
  message.set_maximum_kg_per_m3(static_cast<float>(field.maximum_kg_per_m3));
  message.set_path_kg_per_m2(field.path_kg_per_m2);
  message.set_optical_depth(field.optical_depth);
}

void SetFieldMaximum(const volume::FieldPeak& peak, const StormPlaces& places,
                     v1::FieldMaximum& message) {
  Name(places.fields(), peak.index, message);
  if (peak.value <= 0.0F) return;
  const auto terrain_m = [&](const glm::dvec2& place_m) {
    return volume::TerrainHeight_m(places.fields(), place_m);
  };
  message.set_value(peak.value);
  message.set_value_kg_per_m3(static_cast<float>(peak.kg_per_m3));
  SetPosition(peak.position_m, *message.mutable_position());
  const glm::dvec2 place_m(peak.position_m);
  if (const auto earth = places.OnEarth(place_m)) *message.mutable_earth() = *earth;
  message.set_height_above_ground_m(static_cast<float>(peak.position_m.z - terrain_m(place_m)));
  message.set_column(static_cast<float>(peak.column_kg_per_m2));
  SetPosition({peak.column_position_m, terrain_m(peak.column_position_m)},
              *message.mutable_column_position());
  if (const auto earth = places.OnEarth(peak.column_position_m)) {
    *message.mutable_column_earth() = *earth;
  }
}

}  // namespace

StormPlaces::StormPlaces(const storm_store::StormInfo& storm, int time_index,
                         const volume::HydrometeorFields& fields)
    : middle_(storm_store::MiddleOf(storm, static_cast<std::size_t>(time_index))),
      fields_(fields),
      projection_(storm_store::ProjectionOf(storm, static_cast<std::size_t>(time_index))) {}

std::optional<v1::EarthPlace> StormPlaces::OnEarth(const glm::dvec2& place_m) const {
  if (!projection_.has_value()) return std::nullopt;
  const std::optional<volume::EarthPlace> place = projection_->PlaceOf(place_m);
  if (!place.has_value()) return std::nullopt;
  return PlaceMessage(*place);
}

std::optional<v1::EarthPlace> StormPlaces::Middle() const {
  if (!middle_.has_value()) return std::nullopt;
  return PlaceMessage(*middle_);
}

std::optional<v1::PlaceTable> StormPlaces::Table() const {
  if (!projection_.has_value()) return std::nullopt;
  const glm::dvec2 size_m = glm::dvec2(fields_.grid.cells) * glm::dvec2(fields_.grid.spacing_m);
  const double reach_deg =
      std::min(glm::degrees(kReach * std::max(size_m.x, size_m.y) / kEarth_m), kFarthest_deg);
  const volume::PlaceTable table =
      volume::MakePlaceTable(*projection_, *middle_, kNodes, reach_deg);
  v1::PlaceTable message;
  message.set_nodes(static_cast<std::uint32_t>(table.nodes));
  message.set_reach_deg(table.reach_deg);
  message.mutable_x_m()->Assign(table.x_m.begin(), table.x_m.end());
  message.mutable_y_m()->Assign(table.y_m.begin(), table.y_m.end());
  return message;
}

v1::RayPlace StormPlaces::Of(const scene::StormRay& ray, double along_m) const {
  const glm::dvec3 place_m = ray.At_m(along_m);
  v1::RayPlace message;
  message.set_distance_m(along_m);
  SetPosition(place_m, *message.mutable_position());
  if (const auto earth = OnEarth(glm::dvec2(place_m))) *message.mutable_earth() = *earth;
  message.set_height_m(place_m.z);
  message.set_height_above_ground_m(place_m.z -
                                    volume::TerrainHeight_m(fields_, glm::dvec2(place_m)));
  return message;
}

v1::RayPlace StormPlaces::OnGround(const scene::StormRay& ray, double along_m) const {
  v1::RayPlace message = Of(ray, along_m);
  message.set_height_m(volume::TerrainHeight_m(fields_, glm::dvec2(ray.At_m(along_m))));
  message.set_height_above_ground_m(0.0);
  return message;
}

void ToMessage(const scene::ViewRay& ray, const scene::StormRay& storm_ray,
               const scene::RayProbe& probe, const StormPlaces& places,
               v1::ProbeRayResponse& message) {
  v1::RayOrigin& origin = *message.mutable_ray()->mutable_origin();
  origin.set_x_m(ray.origin_m.x);
  origin.set_y_m(ray.origin_m.y);
  origin.set_z_m(ray.origin_m.z);
  v1::Vector& direction = *message.mutable_ray()->mutable_direction();
  direction.set_x(static_cast<float>(ray.direction.x));
  direction.set_y(static_cast<float>(ray.direction.y));
  direction.set_z(static_cast<float>(ray.direction.z));
  message.set_optical_depth(storm_ray.OpticalDepth());
  if (probe.first_cloud_m.has_value()) {
    *message.mutable_first_cloud() = places.Of(storm_ray, *probe.first_cloud_m);
  }
  if (probe.depth_one_m.has_value()) {
    *message.mutable_depth_one() = places.Of(storm_ray, *probe.depth_one_m);
  }
  if (const auto ground_m = storm_ray.Ground_m()) {
    *message.mutable_ground() = places.OnGround(storm_ray, *ground_m);
  }
  message.set_seen(SeenMessage(storm_ray.WhatIsSeen()));
  if (storm_ray.WhatIsSeen() == scene::Seen::kGround) {
    *message.mutable_seen_place() = message.ground();
  } else if (const auto seen_m = storm_ray.WhereSeen_m()) {
    *message.mutable_seen_place() = places.Of(storm_ray, *seen_m);
  }
  for (const double distance_m : probe.distances_m) {
    message.add_distances_m(distance_m);
    message.add_heights_m(static_cast<float>(storm_ray.At_m(distance_m).z));
  }
  message.mutable_extinctions_per_m()->Assign(probe.extinctions_per_m.begin(),
                                              probe.extinctions_per_m.end());
  for (const scene::FieldOnRay& field : probe.fields) {
    SetFieldAlongRay(field, storm_ray, places, *message.add_fields());
  }
}

void ToMessage(const volume::StormMap& map, const StormPlaces& places,
               v1::GetStormMapResponse& message) {
  message.set_width_px(static_cast<std::uint32_t>(map.size_px.x));
  message.set_height_px(static_cast<std::uint32_t>(map.size_px.y));
  message.mutable_values()->Assign(map.values.begin(), map.values.end());
  float minimum = 0.0F;
  for (const float value : map.values) {
    if (value > 0.0F && (minimum == 0.0F || value < minimum)) minimum = value;
  }
  message.set_minimum(minimum);
  message.set_maximum(*std::ranges::max_element(map.values));
  const volume::RegularGrid& grid = places.fields().grid;
  const glm::dvec3 low_m = grid.low_corner_m;
  const glm::dvec3 high_m = grid.HighCorner_m();
  SetPosition(low_m, *message.mutable_low());
  SetPosition(high_m, *message.mutable_high());
  for (const glm::dvec2& corner_m : {glm::dvec2(low_m), glm::dvec2(high_m.x, low_m.y),
                                     glm::dvec2(high_m), glm::dvec2(low_m.x, high_m.y)}) {
    if (const auto earth = places.OnEarth(corner_m)) *message.add_corners() = *earth;
  }
  // The corners are set only if all four exist. A map that reaches a pole has none there.
  if (message.corners_size() < 4) message.clear_corners();
  if (const auto middle = places.Middle()) *message.mutable_middle() = *middle;
  message.mutable_terrain_height_m()->Assign(map.terrain_height_m.begin(),
                                             map.terrain_height_m.end());
  for (const volume::FieldPeak& peak : map.peaks)
    SetFieldMaximum(peak, places, *message.add_maxima());
}

}  // namespace thunderhead::service
