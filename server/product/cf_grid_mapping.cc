#include "product/cf_grid_mapping.h"

#include "absl/strings/str_cat.h"

namespace thunderhead::product {

absl::StatusOr<CfGridMapping> GridMappingOf(const MapProjection& projection) {
  const std::string kind = projection.Text("proj");
  const auto number = [&projection](const char* name) {
    return std::vector{projection.Number(name)};
  };
  CfGridMapping mapping;
  mapping.numbers["earth_radius"] = number("R");
  std::string& name = mapping.texts["grid_mapping_name"];
  if (kind == "eqc") {
    mapping.in_degrees = true;
    name = "latitude_longitude";
    return mapping;
  }
  if (kind == "lcc") {
    name = "lambert_conformal_conic";
    mapping.numbers["standard_parallel"] = {projection.Number("lat_1"), projection.Number("lat_2")};
    mapping.numbers["latitude_of_projection_origin"] = number("lat_0");
    mapping.numbers["longitude_of_central_meridian"] = number("lon_0");
  } else if (kind == "stere") {
    name = "polar_stereographic";
    mapping.numbers["standard_parallel"] = number("lat_ts");
    mapping.numbers["latitude_of_projection_origin"] = number("lat_0");
    mapping.numbers["straight_vertical_longitude_from_pole"] = number("lon_0");
  } else if (kind == "merc") {
    name = "mercator";
    mapping.numbers["standard_parallel"] = number("lat_ts");
    mapping.numbers["longitude_of_projection_origin"] = number("lon_0");
  } else {
    return absl::InvalidArgumentError(absl::StrCat("CF netCDF has no name for the map projection '",
                                                   kind, "'; use a .tif or .exr"));
  }
  mapping.numbers["false_easting"] = number("x_0");
  mapping.numbers["false_northing"] = number("y_0");
  mapping.texts["crs_wkt"] = projection.IsoText();
  return mapping;
}

}  // namespace thunderhead::product
