// Converts the attributes of a CF grid mapping variable (CF-1.11, appendix F) to a map projection
// in PROJ's notation, which volume::MapProjection opens. docs/storm_files.md lists the mappings.
// This code does not depend on files.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "glm/vec2.hpp"

namespace thunderhead::storm_files {

// The radius of the sphere that is assumed if a grid mapping does not give the figure of the Earth.
inline constexpr double kAssumedEarthRadius_m = 6.371e6;

// An attribute's value: a text, or its numbers.
using AttributeValue = std::variant<std::string, std::vector<double>>;
using Attributes = std::map<std::string, AttributeValue, std::less<>>;

// The quantity along the x and y axes of a grid.
enum class GridAxes {
  kMetres,          // coordinates on the map, in metres or kilometres
  kDegrees,         // longitude and latitude
  kRotatedDegrees,  // grid_longitude and grid_latitude, in degrees
  kScanAngles,      // a satellite's scanning angles, in radians
};

struct GridMapping {
  std::string projection;  // volume::ProjectionText::Parse accepts it
  GridAxes axes = GridAxes::kMetres;
  // Metres on the map per unit of x and y. A grid of degrees is even in metres only with these
  // factors.
  glm::dvec2 metres_per_unit{1.0};
  // Values of x and y at the origin of the map.
  glm::dvec2 origin{0.0};
  // The assumptions that this code made because the attributes leave something open, as sentences
  // for the user.
  std::vector<std::string> assumptions;

  // Returns the position on the map, in metres, of values of x and y.
  // volume::MapProjection::Open(projection) gives its place on Earth.
  glm::dvec2 Plane_m(const glm::dvec2& coordinates) const {
    return (coordinates - origin) * metres_per_unit;
  }
};

// Properties of the grid whose mapping is converted.
struct MappedGrid {
  // Values of x and y in the middle of the grid. Only grids of degrees need them.
  glm::dvec2 middle{0.0};
  // The length of one unit of x and y in metres, if their unit is a length. Without it, x and y are
  // taken to be in metres, or in radians for a geostationary grid.
  std::optional<double> unit_m;
};

// Returns the projection that the attributes of a grid mapping variable describe. The attribute
// crs_wkt, or GDAL's spatial_ref, is used only if there is no grid_mapping_name. Returns
// INVALID_ARGUMENT, which names the attribute, if an attribute is missing or wrong, or if the
// mapping is not supported. The caller adds the names of the file and the variable.
absl::StatusOr<GridMapping> ReadGridMapping(const Attributes& attributes, const MappedGrid& grid);

// Returns the figure of the Earth that the attributes of a grid mapping variable give, in PROJ's
// notation, such as "+a=6378137 +rf=298.25". It is empty if they give none that can be used.
std::string EarthFigureOf(const Attributes& attributes);

// Returns the longitude of the prime meridian from which a grid mapping's longitudes count, in
// degrees east of Greenwich. It is longitude_of_prime_meridian, or else that of the name in
// prime_meridian_name, or else that of the well-known text, or else 0. Returns INVALID_ARGUMENT,
// which names the attribute, for a number that is missing or impossible and for an unknown name.
absl::StatusOr<double> PrimeMeridianOf(const Attributes& attributes);

}  // namespace thunderhead::storm_files
