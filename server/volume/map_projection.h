// Converts between world coordinates and places on Earth, with the map projections in
// StormInfo::projection, on the sphere. Formulas: Snyder 1987, Map Projections - A Working Manual
// (USGS Professional Paper 1395), equations 7-1, 7-5, 15-1 to 15-11, 21-15 to 21-18 and 12-1. This
// code does not depend on files.
#pragma once

#include <optional>
#include <string_view>

#include "glm/vec2.hpp"

namespace thunderhead::volume {

struct EarthPlace {
  double latitude_deg = 0.0;   // north
  double longitude_deg = 0.0;  // east, -180 to 180

  bool operator==(const EarthPlace&) const = default;
};

class MapProjection {
 public:
  // Returns the projection of a grid whose middle is at `middle`. `proj` is a PROJ string. Returns
  // nothing for an empty string or an unsupported projection. Supported are lcc, stere centred on a
  // pole, merc and eqc, all on a sphere.
  static std::optional<MapProjection> Of(std::string_view proj, const EarthPlace& middle);

  // Returns the place at these metres east and north of the domain's middle, or nothing if they lie
  // beyond the map.
  std::optional<EarthPlace> PlaceOf(const glm::dvec2& world_m) const;
  // Returns the metres east and north of the middle for a place, or nothing if it is not on the
  // map.
  std::optional<glm::dvec2> WorldOf(const EarthPlace& place) const;

 private:
  enum class Kind { kConic, kPolar, kMercator, kPlateCarree };

  MapProjection() = default;
  std::optional<glm::dvec2> Project(const EarthPlace& place) const;
  std::optional<EarthPlace> Unproject(const glm::dvec2& map_m) const;

  Kind kind_ = Kind::kConic;
  double radius_m_ = 0.0;
  double longitude0_deg_ = 0.0;
  double latitude0_ = 0.0;  // radians
  double cone_ = 1.0;       // Snyder's cone constant n; 1 for the polar projection
  double scale_m_ = 0.0;    // R F for a cone, 2 R k0 for the polar projection, R cos(lat_ts) for a
                            // cylinder
  double origin_m_ = 0.0;   // distance on the map from latitude0_ to the cone's tip
  double pole_ = 1.0;       // 1 for the north pole, -1 for the south pole
  glm::dvec2 middle_m_{0.0};
};

}  // namespace thunderhead::volume
