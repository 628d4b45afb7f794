#include "product/cf_grid_mapping.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "glm/trigonometric.hpp"

namespace thunderhead::product {
namespace {

// Fills in the attributes of one projection.
class Attributes {
 public:
  Attributes(const volume::ProjectionText& text, CfGridMapping& mapping)
      : text_(text), mapping_(mapping) {}

  double Number(const char* parameter, double otherwise = 0.0) const {
    return text_.Number(parameter).value_or(otherwise);
  }
  void Name(const char* name) { mapping_.texts["grid_mapping_name"] = name; }
  void Set(const char* name, double value) { mapping_.numbers[name] = {value}; }
  void Origin(const char* latitude, const char* longitude) {
    if (latitude != nullptr) Set(latitude, Number("lat_0"));
    Set(longitude, Number("lon_0"));
  }
  // Sets the latitude of true scale, or else the scale at the origin.
  void Scale() {
    if (text_.Has("lat_ts")) return Set("standard_parallel", Number("lat_ts"));
    Set("scale_factor_at_projection_origin", ScaleFactor());
  }
  double ScaleFactor() const { return Number("k_0", Number("k", 1.0)); }
  void Parallels() {
    const double first = Number("lat_1");
    const double second = Number("lat_2", first);
    std::vector<double>& parallels = mapping_.numbers["standard_parallel"];
    parallels = {first};
    if (second != first) parallels.push_back(second);
  }

 private:
  const volume::ProjectionText& text_;
  CfGridMapping& mapping_;
};

constexpr char kLatitude[] = "latitude_of_projection_origin";
constexpr char kLongitude[] = "longitude_of_projection_origin";
constexpr char kMeridian[] = "longitude_of_central_meridian";

void SetConic(Attributes& set, const char* name) {
  set.Name(name);
  set.Parallels();
  set.Origin(kLatitude, kMeridian);
}

void SetStereographic(Attributes& set) {
  if (std::abs(set.Number("lat_0")) == 90.0) {
    set.Name("polar_stereographic");
    set.Origin(kLatitude, "straight_vertical_longitude_from_pole");
    set.Scale();
  } else {
    set.Name("stereographic");
    set.Origin(kLatitude, kLongitude);
    set.Set("scale_factor_at_projection_origin", set.ScaleFactor());
  }
}

void SetTransverseMercator(Attributes& set) {
  set.Name("transverse_mercator");
  set.Origin(kLatitude, kMeridian);
  set.Set("scale_factor_at_central_meridian", set.ScaleFactor());
}

void SetGeostationary(Attributes& set, const std::string& sweep, CfGridMapping& mapping) {
  const double height_m = set.Number("h");
  set.Name("geostationary");
  set.Origin(kLatitude, kLongitude);
  set.Set("perspective_point_height", height_m);
  mapping.texts["sweep_angle_axis"] = sweep.empty() ? "y" : sweep;
  mapping.x = {"x", "radian", "projection_x_angular_coordinate", 0.0, 1.0 / height_m};
  mapping.y = {"y", "radian", "projection_y_angular_coordinate", 0.0, 1.0 / height_m};
}

// Returns false if the conventions have no name for the projection.
bool SetProjected(const volume::ProjectionText& text, CfGridMapping& mapping) {
  Attributes set(text, mapping);
  const std::string& kind = text.Kind();
  if (kind == "lcc") {
    SetConic(set, "lambert_conformal_conic");
  } else if (kind == "aea") {
    SetConic(set, "albers_conical_equal_area");
  } else if (kind == "stere") {
    SetStereographic(set);
  } else if (kind == "merc") {
    set.Name("mercator");
    set.Scale();
    set.Origin(nullptr, kLongitude);
  } else if (kind == "cea") {
    set.Name("lambert_cylindrical_equal_area");
    set.Scale();
    set.Origin(nullptr, kMeridian);
  } else if (kind == "tmerc") {
    SetTransverseMercator(set);
  } else if (kind == "laea") {
    set.Name("lambert_azimuthal_equal_area");
    set.Origin(kLatitude, kLongitude);
  } else if (kind == "aeqd") {
    set.Name("azimuthal_equidistant");
    set.Origin(kLatitude, kLongitude);
  } else if (kind == "geos") {
    SetGeostationary(set, text.Text("sweep"), mapping);
  } else {
    return false;
  }
  // CF requires false origins in the unit of the axes, and `text` has them in metres.
  set.Set("false_easting", set.Number("x_0") * mapping.x.per_metre);
  set.Set("false_northing", set.Number("y_0") * mapping.y.per_metre);
  return true;
}

// Sets the name, parameters and axes of a grid in degrees, which may have a rotated pole.
void SetDegrees(const volume::ProjectionText& text, double radius_m, CfGridMapping& mapping) {
  Attributes set(text, mapping);
  const double per_metre = glm::degrees(1.0 / radius_m);
  const double stretch = std::cos(glm::radians(set.Number("lat_ts")));
  mapping.x.per_metre = per_metre / stretch;
  mapping.y.per_metre = per_metre;
  mapping.y.origin = set.Number("lat_0");
  if (!text.HasRotatedPole()) {
    set.Name("latitude_longitude");
    mapping.in_degrees = true;
    mapping.x = {"lon", "degrees_east", "longitude", set.Number("lon_0"), mapping.x.per_metre};
    mapping.y = {"lat", "degrees_north", "latitude", mapping.y.origin, mapping.y.per_metre};
    return;
  }
  set.Name("rotated_latitude_longitude");
  set.Set("grid_north_pole_latitude", set.Number("o_lat_p"));
  set.Set("grid_north_pole_longitude", std::remainder(set.Number("lon_0") - 180.0, 360.0));
  set.Set("north_pole_grid_longitude", set.Number("o_lon_p"));
  mapping.x = {"rlon", "degrees", "grid_longitude", 0.0, mapping.x.per_metre};
  mapping.y = {"rlat", "degrees", "grid_latitude", mapping.y.origin, mapping.y.per_metre};
}

void SetFigure(const volume::EarthFigure& figure, double meridian, CfGridMapping& mapping) {
  if (figure.inverse_flattening > 0.0) {
    mapping.numbers["semi_major_axis"] = {figure.semi_major_m};
    mapping.numbers["inverse_flattening"] = {figure.inverse_flattening};
  } else {
    mapping.numbers["earth_radius"] = {figure.semi_major_m};
  }
  if (meridian != 0.0) mapping.numbers["longitude_of_prime_meridian"] = {meridian};
}

}  // namespace

absl::StatusOr<CfGridMapping> GridMappingOf(const volume::MapProjection& projection) {
  const volume::ProjectionText& text = projection.Text();
  const volume::EarthFigure figure = projection.Figure();
  CfGridMapping mapping;
  SetFigure(figure, text.Number("pm").value_or(0.0), mapping);
  if (text.Kind() == "eqc") {
    SetDegrees(text, figure.semi_major_m, mapping);
    return mapping;
  }
  const double unit_m = text.Number("to_meter").value_or(1.0);
  mapping.x = {"x", "m", "projection_x_coordinate", 0.0, 1.0};
  mapping.y = {"y", "m", "projection_y_coordinate", 0.0, 1.0};
  if (!SetProjected(text, mapping)) {
    return absl::InvalidArgumentError(absl::StrCat("CF netCDF has no name for the map projection '",
                                                   text.Kind(), "'; use a .tif or .exr"));
  }
  mapping.x.per_metre *= unit_m;
  mapping.y.per_metre *= unit_m;
  mapping.texts["crs_wkt"] = projection.WellKnownText(volume::MapProjection::WellKnown::kIso);
  return mapping;
}

}  // namespace thunderhead::product
