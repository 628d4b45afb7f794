#include "product/light_netcdf.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "base/status.h"
#include "netcdf/netcdf_writer.h"
#include "product/cf_grid_mapping.h"
#include "volume/map_projection.h"

namespace thunderhead::product {
namespace {

using netcdf::NetcdfWriter;

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

std::string Iso(absl::Time time) {
  return absl::FormatTime("%E4Y-%m-%d %H:%M:%S", time, absl::UTCTimeZone());
}

// Returns the name of a global attribute in CF style: lower case, with underscores instead of dots.
std::string AttributeName(const std::string& name) {
  return absl::AsciiStrToLower(absl::StrReplaceAll(name, {{".", "_"}}));
}

// Writes the file. Values are collected when their variables are declared, and written after all
// declarations.
class LightFile {
 public:
  LightFile(const LightMap& map, const std::string& what) : map_(map), file_(what) {}

  absl::StatusOr<std::string> Write() {
    THUNDERHEAD_RETURN_IF_ERROR(Axes());
    Time("time", map_.valid);
    if (map_.run.has_value()) Time("forecast_reference_time", *map_.run);
    Fields();
    Globals();
    file_.EndDefinitions();
    for (const auto& [variable, values] : doubles_) file_.Values(variable, values);
    for (const auto& [variable, values] : floats_) file_.Values(variable, values);
    std::string bytes = file_.Take();
    if (file_.Good()) return bytes;
    return absl::InternalError(
        absl::StrCat("netCDF-C cannot encode the picture: ", nc_strerror(file_.Code())));
  }

 private:
  std::size_t Width() const { return static_cast<std::size_t>(map_.picture.size_px.x); }
  std::size_t Height() const { return static_cast<std::size_t>(map_.picture.size_px.y); }

  absl::Status Axes() {
    std::vector<double> columns;
    columns.reserve(Width());
    for (int x = 0; x < map_.picture.size_px.x; ++x) {
      columns.push_back(map_.place.MiddleOf_m(x, 0).x);
    }
    std::vector<double> rows;
    rows.reserve(Height());
    for (int y = 0; y < map_.picture.size_px.y; ++y) {
      rows.push_back(map_.place.MiddleOf_m(0, y).y);
    }
    if (map_.place.projection.empty()) {
      Axis("x", std::move(columns),
           {{"axis", "X"},
            {"units", "m"},
            {"long_name", "metres east of the middle of the domain"}});
      Axis("y", std::move(rows),
           {{"axis", "Y"},
            {"units", "m"},
            {"long_name", "metres north of the middle of the domain"}});
      dimensions_ = {1, 0};
      return absl::OkStatus();
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(const volume::MapProjection projection,
                                 volume::MapProjection::Open(map_.place.projection));
    THUNDERHEAD_ASSIGN_OR_RETURN(const CfGridMapping mapping, GridMappingOf(projection));
    if (!mapping.in_degrees) PlacesOf(projection, columns, rows);
    MapAxis(mapping.x, "X", std::move(columns));
    MapAxis(mapping.y, "Y", std::move(rows));
    if (!mapping.in_degrees) {
      PlaceField("lat", "latitude", "degrees_north", std::move(latitudes_));
      PlaceField("lon", "longitude", "degrees_east", std::move(longitudes_));
      coordinates_ = {"lat", "lon"};
    }
    dimensions_ = {1, 0};
    const int crs = file_.Variable("crs", NC_INT, {});
    for (const auto& [name, text] : mapping.texts) file_.Text(crs, name.c_str(), text);
    for (const auto& [name, numbers] : mapping.numbers) file_.Numbers(crs, name.c_str(), numbers);
    mapped_ = true;
    return absl::OkStatus();
  }

  // Computes the latitude and longitude of each pixel; NaN beyond the map.
  void PlacesOf(const volume::MapProjection& projection, const std::vector<double>& columns,
                const std::vector<double>& rows) {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    for (const double y : rows) {
      for (const double x : columns) {
        const auto place =
            projection.PlaceOf({x, y}).value_or(volume::EarthPlace{kNowhere, kNowhere});
        latitudes_.push_back(place.latitude_deg);
        longitudes_.push_back(place.longitude_deg);
      }
    }
  }

  using Attributes = std::vector<std::pair<const char*, std::string>>;

  // Writes an axis of the map. `values` are the projection's own coordinates.
  void MapAxis(const CfMapAxis& axis, const char* direction, std::vector<double> values) {
    for (double& value : values) value = axis.origin + axis.per_metre * value;
    Axis(axis.name.c_str(), std::move(values),
         {{"axis", direction}, {"units", axis.units}, {"standard_name", axis.standard_name}});
  }

  void Axis(const char* name, std::vector<double> values, const Attributes& attributes) {
    const int variable = file_.Variable(name, NC_DOUBLE, {file_.Dimension(name, values.size())});
    for (const auto& [attribute, text] : attributes) file_.Text(variable, attribute, text);
    doubles_.emplace_back(variable, std::move(values));
  }

  void PlaceField(const char* name, const char* standard_name, const char* units,
                  std::vector<double> values) {
    const int variable = file_.Variable(name, NC_DOUBLE, {1, 0});
    file_.Text(variable, "standard_name", standard_name);
    file_.Text(variable, "units", units);
    file_.Number(variable, "_FillValue", std::numeric_limits<double>::quiet_NaN());
    doubles_.emplace_back(variable, std::move(values));
  }

  // Adds a time variable; its name is its standard name.
  void Time(const char* name, absl::Time time) {
    const absl::Time epoch = map_.run.value_or(map_.valid);
    const int variable = file_.Variable(name, NC_DOUBLE, {});
    file_.Text(variable, "standard_name", name);
    file_.Text(variable, "units", absl::StrCat("seconds since ", Iso(epoch)));
    // Models use the proleptic Gregorian calendar. It must be named, because CF's default calendar
    // is Julian before 1582.
    file_.Text(variable, "calendar", "proleptic_gregorian");
    doubles_.emplace_back(variable, std::vector{absl::ToDoubleSeconds(time - epoch)});
    coordinates_.emplace_back(name);
  }

  void Field(const char* name, const std::string& long_name, const char* units,
             std::vector<float> values) {
    if (values.empty()) return;
    const int variable = file_.Variable(name, NC_FLOAT, dimensions_);
    file_.Fill(variable, kMissing);
    file_.Text(variable, "long_name", long_name);
    file_.Text(variable, "units", units);
    if (mapped_) file_.Text(variable, "grid_mapping", "crs");
    file_.Text(variable, "coordinates", absl::StrJoin(coordinates_, " "));
    floats_.emplace_back(variable, std::move(values));
  }

  static std::vector<float> ColorOf(const std::vector<glm::vec3>& values, int color) {
    std::vector<float> one;
    one.reserve(values.size());
    for (const glm::vec3& value : values) one.push_back(value[color]);
    return one;
  }

  void Fields() {
    const picture::LinearPicture& picture = map_.picture;
    constexpr std::array<const char*, 3> kColors = {"red", "green", "blue"};
    for (int color = 0; color < 3; ++color) {
      const std::string name = kColors[static_cast<std::size_t>(color)];
      Field(absl::StrCat("radiance_", name).c_str(),
            absl::StrCat("radiance upwards in ", name,
                         " (linear sRGB), in units of the sun's irradiance above the atmosphere"),
            "sr-1", ColorOf(picture.radiance, color));
      Field(absl::StrCat("radiance_", name, "_standard_error").c_str(),
            absl::StrCat("standard error of radiance_", name), "sr-1",
            ColorOf(picture.standard_error, color));
    }
    Field("storm_opacity", "share of the pixel that the storm covers", "1", picture.opacity);
    Field("storm_optical_depth", "optical depth of the storm from above down to the ground", "1",
          picture.optical_depth);
    std::vector<float> heights_m = picture.depth_one_distance_m;
    for (float& height_m : heights_m) {
      height_m =
          std::isfinite(height_m) ? static_cast<float>(map_.eye_altitude_m - height_m) : kMissing;
    }
    Field("depth_one_height",
          "height above sea level at which the storm's optical depth from above reaches 1", "m",
          std::move(heights_m));
    Field("depth_one_distance",
          "distance from the eye at which the storm's optical depth reaches 1", "m",
          FiniteOf(picture.depth_one_distance_m));
    if (!map_.estimated_error.has_value()) return;
    const int error = file_.Variable("estimated_error", NC_DOUBLE, {});
    file_.Text(error, "long_name", "estimated relative RMSE of the radiance");
    file_.Text(error, "units", "1");
    doubles_.emplace_back(error, std::vector{*map_.estimated_error});
  }

  static std::vector<float> FiniteOf(std::vector<float> values) {
    for (float& value : values) {
      if (!std::isfinite(value)) value = kMissing;
    }
    return values;
  }

  void Globals() {
    file_.Text(NC_GLOBAL, "Conventions", "CF-1.8");
    file_.Number(NC_GLOBAL, "eye_altitude_m", map_.eye_altitude_m);
    for (const auto& [name, text] : map_.texts) {
      file_.Text(NC_GLOBAL, name == "Software" ? "source" : AttributeName(name).c_str(), text);
    }
  }

  const LightMap& map_;
  NetcdfWriter file_;
  // Identifiers of netCDF-C. The dimension x is declared first, but is the last dimension of
  // variables.
  std::vector<int> dimensions_;
  std::vector<double> latitudes_;
  std::vector<double> longitudes_;
  std::vector<std::string> coordinates_;
  bool mapped_ = false;
  std::vector<std::pair<int, std::vector<double>>> doubles_;
  std::vector<std::pair<int, std::vector<float>>> floats_;
};

}  // namespace

absl::StatusOr<std::string> EncodeLightNetcdf(const LightMap& map, const std::string& what) {
  return LightFile(map, what).Write();
}

}  // namespace thunderhead::product
