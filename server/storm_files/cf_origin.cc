#include "storm_files/cf_origin.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "glm/vec2.hpp"
#include "storm_files/cf_places.h"

namespace thunderhead::storm_files {

std::optional<CfOrigin> ReadCfOrigin(const netcdf::NetcdfFile& file) {
  const auto latitude_deg = file.NumberAttribute("", "origin_lat");
  const auto longitude_deg = file.NumberAttribute("", "origin_lon");
  // The negated comparisons also refuse NaN.
  if (!latitude_deg.has_value() || !longitude_deg.has_value() ||
      !(std::abs(*latitude_deg) < 90.0) || !(std::abs(*longitude_deg) <= 360.0)) {
    return std::nullopt;
  }
  return CfOrigin{{.latitude_deg = *latitude_deg, .longitude_deg = *longitude_deg},
                  file.NumberAttribute("", "rotation_angle").value_or(0.0)};
}

std::optional<double> ReadCfOriginHeight_m(const netcdf::NetcdfFile& file) {
  const auto height_m = file.NumberAttribute("", "origin_z");
  constexpr double kHighest_m = 10'000.0;
  if (!height_m.has_value() || !(std::abs(*height_m) < kHighest_m)) return std::nullopt;
  return height_m;
}

ColumnPlaces PlacesFromOrigin(const CfOrigin& origin, const CfAxis& x, const CfAxis& y) {
  ColumnPlaces places;
  places.columns = {x.cells, y.cells};
  places.projection =
      absl::StrFormat("+proj=aeqd +lat_0=%.10g +lon_0=%.10g +R=%.10g +no_defs",
                      origin.place.latitude_deg, origin.place.longitude_deg, kCfEarthRadius_m);
  places.step = {x.Spacing(), y.Spacing()};
  places.first = glm::dvec2(x.faces.front(), y.faces.front()) + 0.5 * places.step;
  return places;
}

}  // namespace thunderhead::storm_files
