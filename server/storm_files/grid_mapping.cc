#include "storm_files/grid_mapping.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/true_scale.h"
#include "volume/map_projection.h"
#include "volume/projection_text.h"

namespace thunderhead::storm_files {
namespace {

// Returns the shortest text that parses to exactly this number.
std::string Exact(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value + 0.0);
  return std::string(text.data(), end.ptr);
}

// Ellipsoids by CF's names, in lower case, and PROJ's names for them.
struct Ellipsoid {
  std::string_view name;
  std::string_view proj;
};
constexpr std::array kEllipsoids = {
    Ellipsoid{"wgs 84", "WGS84"},       Ellipsoid{"wgs84", "WGS84"},
    Ellipsoid{"wgs 1984", "WGS84"},     Ellipsoid{"grs 1980", "GRS80"},
    Ellipsoid{"grs80", "GRS80"},        Ellipsoid{"bessel 1841", "bessel"},
    Ellipsoid{"clarke 1866", "clrk66"}, Ellipsoid{"international 1924", "intl"},
};

// Composes a projection from attributes. The first problem is kept, and the functions that add
// parameters then do nothing, so that a caller checks once at the end.
class Composer {
 public:
  Composer(const Attributes& attributes, const MappedGrid& grid)
      : attributes_(attributes), grid_(grid) {
    mapping_.metres_per_unit = glm::dvec2(grid.unit_m.value_or(1.0));
  }

  void Start(std::string_view proj) { text_ = absl::StrCat("+proj=", std::string(proj)); }
  void Add(const char* parameter, const std::string& value) {
    absl::StrAppend(&text_, " +", parameter, "=", value);
  }
  void Add(const char* parameter, double value) { Add(parameter, Exact(value)); }

  bool Has(const std::string& name) const { return attributes_.contains(name); }

  // The functions from here to Positive return an attribute. If the attribute is missing or wrong,
  // they record a problem, and their result is not used.
  std::vector<double> Numbers(const std::string& name) {
    const auto found = attributes_.find(name);
    if (found == attributes_.end()) {
      Fail(absl::StrCat("has no attribute ", name, ", which ", name_, " needs"));
      return {};
    }
    const auto* const numbers = std::get_if<std::vector<double>>(&found->second);
    const bool good =
        numbers != nullptr && !numbers->empty() &&
        std::ranges::all_of(*numbers, [](double value) { return std::isfinite(value); });
    if (good) return *numbers;
    Fail(absl::StrCat("has an attribute ", name, " without a number"));
    return {};
  }
  double Number(const std::string& name) {
    const std::vector<double> numbers = Numbers(name);
    if (numbers.size() > 1)
      Fail(absl::StrCat("has several numbers in ", name, " where one is needed"));
    return numbers.empty() ? 0.0 : numbers.front();
  }
  double NumberOr(const std::string& name, double otherwise) {
    return Has(name) ? Number(name) : otherwise;
  }
  double Latitude(const std::string& name) { return Within(name, Number(name), 90.0); }
  double Longitude(const std::string& name) {
    return std::remainder(Within(name, Number(name), 720.0), 360.0);
  }
  double Positive(const std::string& name) {
    const double value = Number(name);
    if (!(value > 0.0)) Fail(absl::StrCat("has ", name, " ", value, ", which must be above zero"));
    return value;
  }
  std::string Text(const std::string& name) const {
    const auto found = attributes_.find(name);
    const auto* const text =
        found == attributes_.end() ? nullptr : std::get_if<std::string>(&found->second);
    return text == nullptr ? "" : std::string(absl::StripAsciiWhitespace(*text));
  }

  double Within(const std::string& name, double value, double most) {
    if (!(std::abs(value) <= most)) {
      Fail(absl::StrCat("has ", name, " ", value, ", which is not from ", -most, " to ", most));
    }
    return value;
  }

  void Fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
  }
  void Assume(std::string sentence) { mapping_.assumptions.push_back(std::move(sentence)); }

  // Adds one or two standard parallels.
  void AddParallels() {
    const std::vector<double> parallels = Numbers("standard_parallel");
    if (parallels.size() > 2) Fail("has more than two numbers in standard_parallel");
    if (parallels.empty()) return;
    for (const double parallel : parallels) Within("standard_parallel", parallel, 90.0);
    Add("lat_1", parallels.front());
    Add("lat_2", parallels.back());
  }

  // Adds the latitude of true scale, or else the scale at the origin.
  void AddScale() {
    if (Has("standard_parallel")) {
      Add("lat_ts", Latitude("standard_parallel"));
    } else if (Has("scale_factor_at_projection_origin")) {
      Add("k_0", Positive("scale_factor_at_projection_origin"));
    } else {
      Fail(absl::StrCat("has neither of the attributes standard_parallel and ",
                        "scale_factor_at_projection_origin, of which ", name_, " needs one"));
    }
  }

  void AddFalseOrigin() {
    Add("x_0", NumberOr("false_easting", 0.0) * mapping_.metres_per_unit.x);
    Add("y_0", NumberOr("false_northing", 0.0) * mapping_.metres_per_unit.y);
  }

  // Adds the figure of the Earth.
  void AddEarth() {
    if (Has("earth_radius")) {
      Add("R", Positive("earth_radius"));
    } else if (Has("semi_major_axis")) {
      const double major_m = Positive("semi_major_axis");
      const double inverse = NumberOr("inverse_flattening", 0.0);
      if (Has("semi_minor_axis")) {
        Add("a", major_m);
        Add("b", Positive("semi_minor_axis"));
      } else if (inverse > 1.0) {
        Add("a", major_m);
        Add("rf", inverse);
      } else if (inverse == 0.0) {  // CF's spelling of a sphere
        Add("R", major_m);
      } else {
        Fail(absl::StrCat("has inverse_flattening ", inverse, ", which must be above one or zero"));
      }
    } else {
      AddNamedEarth();
    }
  }

  // Returns the longitude of the prime meridian, in degrees east of Greenwich.
  double PrimeMeridian_deg() {
    const char* const number = "longitude_of_prime_meridian";
    if (Has(number)) return Within(number, Number(number), 360.0);
    if (const std::string name = Text("prime_meridian_name"); !name.empty()) {
      const std::optional<double> known = volume::PrimeMeridianNamed(name);
      if (!known.has_value()) {
        Fail(absl::StrCat("has prime_meridian_name '", absl::CEscape(name), "', which is not ",
                          "known; add ", number, ", its degrees east of Greenwich"));
      }
      return known.value_or(0.0);
    }
    for (const char* const attribute : {"crs_wkt", "spatial_ref"}) {
      const std::string text = Text(attribute);
      if (!text.empty()) return volume::PrimeMeridianOfWellKnownText(text).value_or(0.0);
    }
    return 0.0;
  }

  // Adds the prime meridian from which the map's longitudes count.
  void AddPrimeMeridian() {
    if (const double meridian = PrimeMeridian_deg(); meridian != 0.0) Add("pm", meridian);
  }

  std::string Problem() const { return problem_; }

  // Adds a sphere, for mappings that have no other figure of the Earth. Returns its radius.
  double AddSphere() {
    double radius_m = kAssumedEarthRadius_m;
    if (Has("earth_radius")) {
      radius_m = Positive("earth_radius");
    } else if (Has("semi_major_axis")) {
      radius_m = Positive("semi_major_axis");
      if (Has("semi_minor_axis") || NumberOr("inverse_flattening", 0.0) != 0.0) {
        Assume(absl::StrCat("degrees of ", name_, " are converted to metres on a sphere of ",
                            Exact(radius_m), " m, the ellipsoid's semi-major axis"));
      }
    } else {
      AssumeSphere();
    }
    Add("R", radius_m);
    return radius_m;
  }

  GridMapping& Mapping() { return mapping_; }
  const MappedGrid& Grid() const { return grid_; }
  void Name(std::string name) { name_ = std::move(name); }

  absl::StatusOr<GridMapping> Finish() {
    if (!problem_.empty()) return absl::InvalidArgumentError(problem_);
    absl::StrAppend(&text_, " +units=m +no_defs");
    // The attributes can be sound one by one and still make no map.
    THUNDERHEAD_RETURN_IF_ERROR(volume::MapProjection::Open(text_).status());
    mapping_.projection = text_;
    return std::move(mapping_);
  }

 private:
  void AddNamedEarth() {
    const std::string name = absl::AsciiStrToLower(Text("reference_ellipsoid_name"));
    const auto known = std::ranges::find(kEllipsoids, std::string_view(name), &Ellipsoid::name);
    if (known != kEllipsoids.end()) return Add("ellps", std::string(known->proj));
    AssumeSphere();
    Add("R", kAssumedEarthRadius_m);
  }

  void AssumeSphere() {
    Assume(absl::StrCat("the grid mapping does not give the figure of the Earth (earth_radius or ",
                        "semi_major_axis); a sphere of ", Exact(kAssumedEarthRadius_m),
                        " m is assumed"));
  }

  const Attributes& attributes_;
  const MappedGrid& grid_;
  GridMapping mapping_;
  std::string name_;
  std::string text_;
  std::string problem_;
};

void AddOrigin(Composer& map) {
  map.Add("lat_0", map.Latitude("latitude_of_projection_origin"));
  map.Add("lon_0", map.Longitude("longitude_of_projection_origin"));
}

void AddConic(Composer& map, const char* proj) {
  map.Start(proj);
  map.AddParallels();
  map.Add("lat_0", map.Latitude("latitude_of_projection_origin"));
  map.Add("lon_0", map.Longitude("longitude_of_central_meridian"));
}

void AddAlbers(Composer& map) { AddConic(map, "aea"); }
void AddLambertConic(Composer& map) { AddConic(map, "lcc"); }

void AddLambertAzimuthal(Composer& map) {
  map.Start("laea");
  AddOrigin(map);
}

void AddAzimuthalEquidistant(Composer& map) {
  map.Start("aeqd");
  AddOrigin(map);
}

void AddLambertCylindrical(Composer& map) {
  map.Start("cea");
  map.AddScale();
  map.Add("lon_0", map.Longitude("longitude_of_central_meridian"));
}

void AddMercator(Composer& map) {
  map.Start("merc");
  map.AddScale();
  map.Add("lon_0", map.Longitude("longitude_of_projection_origin"));
}

void AddTransverseMercator(Composer& map) {
  map.Start("tmerc");
  map.Add("lat_0", map.Latitude("latitude_of_projection_origin"));
  map.Add("lon_0", map.Longitude("longitude_of_central_meridian"));
  map.Add("k_0", map.Positive("scale_factor_at_central_meridian"));
}

void AddStereographic(Composer& map) {
  map.Start("stere");
  AddOrigin(map);
  map.Add("k_0", map.Positive("scale_factor_at_projection_origin"));
}

void AddPolarStereographic(Composer& map) {
  map.Start("stere");
  const double pole = map.Latitude("latitude_of_projection_origin");
  if (std::abs(pole) < 90.0 - 1e-6) {
    map.Fail(absl::StrCat("has latitude_of_projection_origin ", pole,
                          ", which must be 90 or -90 for polar_stereographic"));
  }
  map.Add("lat_0", std::copysign(90.0, pole));
  map.AddScale();
  // The second name is in files that follow the conventions before version 1.4.
  const bool vertical = map.Has("straight_vertical_longitude_from_pole") ||
                        !map.Has("longitude_of_projection_origin");
  map.Add("lon_0", map.Longitude(vertical ? "straight_vertical_longitude_from_pole"
                                          : "longitude_of_projection_origin"));
}

void AddGeostationary(Composer& map) {
  map.Start("geos");
  const double height_m = map.Positive("perspective_point_height");
  map.Add("h", height_m);
  map.Add("lon_0", map.Longitude("longitude_of_projection_origin"));
  if (map.NumberOr("latitude_of_projection_origin", 0.0) != 0.0) {
    map.Fail(
        "has a latitude_of_projection_origin other than 0; a geostationary satellite is there");
  }
  std::string sweep = map.Text("sweep_angle_axis");
  if (sweep.empty()) {
    const std::string fixed = map.Text("fixed_angle_axis");
    if (fixed == "x") sweep = std::string("y");
    if (fixed == "y") sweep = std::string("x");
  }
  if (sweep != "x" && sweep != "y") {
    map.Fail("has no attribute sweep_angle_axis (x or y), which geostationary needs");
  }
  map.Add("sweep", sweep);
  if (map.Grid().unit_m.has_value()) return;
  map.Mapping().axes = GridAxes::kScanAngles;
  map.Mapping().metres_per_unit = glm::dvec2(height_m);
}

constexpr double kRadian = glm::pi<double>() / 180.0;

// A grid of degrees is drawn with even spacings in metres, those at its middle.
void AddLatitudeLongitude(Composer& map) {
  const glm::dvec2 middle = map.Grid().middle;
  map.Start("eqc");
  map.Within("the middle latitude", middle.y, 90.0);
  map.Add("lat_ts", middle.y);
  map.Add("lat_0", middle.y);
  map.Add("lon_0", std::remainder(middle.x, 360.0));
  const double per_degree_m = map.AddSphere() * kRadian;
  map.AddPrimeMeridian();
  map.Mapping().axes = GridAxes::kDegrees;
  map.Mapping().metres_per_unit = {per_degree_m * std::cos(glm::radians(middle.y)), per_degree_m};
  map.Mapping().origin = middle;
}

void AddRotatedPole(Composer& map) {
  const double middle_latitude = map.Grid().middle.y;
  map.Start("ob_tran +o_proj=eqc");
  map.Add("o_lat_p", map.Latitude("grid_north_pole_latitude"));
  map.Add("o_lon_p", std::remainder(map.NumberOr("north_pole_grid_longitude", 0.0), 360.0));
  map.Add("lon_0",
          std::remainder(
              map.Longitude("grid_north_pole_longitude") + 180.0 + map.PrimeMeridian_deg(), 360.0));
  map.Within("the middle grid_latitude", middle_latitude, 90.0);
  map.Add("lat_ts", middle_latitude);
  const double per_degree_m = map.AddSphere() * kRadian;
  map.Mapping().axes = GridAxes::kRotatedDegrees;
  map.Mapping().metres_per_unit = {per_degree_m * std::cos(glm::radians(middle_latitude)),
                                   per_degree_m};
}

struct Kind {
  std::string_view name;
  void (*add)(Composer& map);
  bool in_degrees = false;
};
constexpr std::array kKinds = {
    Kind{"albers_conical_equal_area", AddAlbers},
    Kind{"azimuthal_equidistant", AddAzimuthalEquidistant},
    Kind{"geostationary", AddGeostationary},
    Kind{"lambert_azimuthal_equal_area", AddLambertAzimuthal},
    Kind{"lambert_conformal_conic", AddLambertConic},
    Kind{"lambert_cylindrical_equal_area", AddLambertCylindrical},
    Kind{"latitude_longitude", AddLatitudeLongitude, true},
    Kind{"mercator", AddMercator},
    Kind{"polar_stereographic", AddPolarStereographic},
    Kind{"rotated_latitude_longitude", AddRotatedPole, true},
    Kind{"stereographic", AddStereographic},
    Kind{"transverse_mercator", AddTransverseMercator},
};

std::string KnownKinds() {
  std::string names;
  for (const Kind& kind : kKinds) {
    absl::StrAppend(&names, names.empty() ? "" : ", ", std::string(kind.name));
  }
  return names;
}

absl::StatusOr<GridMapping> FromWellKnownText(const std::string& text, const MappedGrid& grid) {
  GridMapping mapping;
  THUNDERHEAD_ASSIGN_OR_RETURN(mapping.projection, volume::ProjectionOfWellKnownText(text));
  mapping.metres_per_unit = glm::dvec2(grid.unit_m.value_or(1.0));
  mapping.assumptions.push_back(
      "the grid mapping has no grid_mapping_name; the map projection is taken from its well-known "
      "text");
  return mapping;
}

}  // namespace

absl::StatusOr<GridMapping> ReadGridMapping(const Attributes& attributes, const MappedGrid& grid) {
  Composer map(attributes, grid);
  const std::string name = map.Text("grid_mapping_name");
  if (name.empty()) {
    for (const char* const attribute : {"crs_wkt", "spatial_ref"}) {
      if (const std::string text = map.Text(attribute); !text.empty()) {
        return FromWellKnownText(text, grid);
      }
    }
    return absl::InvalidArgumentError("has no attribute grid_mapping_name");
  }
  const auto kind = std::ranges::find(kKinds, std::string_view(name), &Kind::name);
  if (kind == kKinds.end()) {
    return absl::InvalidArgumentError(absl::StrCat("has grid_mapping_name '", absl::CEscape(name),
                                                   "', which is not supported; supported are ",
                                                   KnownKinds()));
  }
  map.Name(name);
  kind->add(map);
  if (!kind->in_degrees) {
    map.AddFalseOrigin();
    map.AddEarth();
    map.AddPrimeMeridian();
  }
  return map.Finish();
}

std::string EarthFigureOf(const Attributes& attributes) {
  Composer earth(attributes, {});
  if (!earth.Has("earth_radius") && !earth.Has("semi_major_axis") &&
      !earth.Has("reference_ellipsoid_name")) {
    return "";
  }
  earth.Start("merc");  // any projection that takes an ellipsoid
  earth.AddEarth();
  const absl::StatusOr<GridMapping> mapping = earth.Finish();
  return mapping.ok() ? EarthOf(mapping->projection) : "";
}

absl::StatusOr<double> PrimeMeridianOf(const Attributes& attributes) {
  Composer mapping(attributes, {});
  const double meridian_deg = mapping.PrimeMeridian_deg();
  if (std::string problem = mapping.Problem(); !problem.empty()) {
    return absl::InvalidArgumentError(problem);
  }
  return meridian_deg;
}

}  // namespace thunderhead::storm_files
