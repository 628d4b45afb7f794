#include "storm_files/cf_cells.h"

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "glm/vec2.hpp"
#include "storm_files/cell_columns.h"
#include "storm_files/cf_mapping.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {
namespace {

bool IsNamed(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

// A variable with a coordinate of each cell. Its values times `scale` are degrees.
struct CellCoordinate {
  std::string name;
  double scale = 1.0;
};

// Returns the degrees in a unit of the coordinate. MPAS writes radians, and older versions without
// units.
std::optional<double> ScaleOf(const CfDescription& described, CfDirection direction) {
  if (HasNoUnits(described.units) && IsNamed(described.name, {"lonCell", "latCell"})) {
    return DegreesIn("radian", direction);
  }
  if (described.units == "rad") return DegreesIn("radian", direction);
  return DegreesIn(described.units, direction);
}

bool HoldsPlaces(const CfDescription& described, CfDirection direction) {
  const bool east = direction == CfDirection::kX;
  if (described.standard_name == (east ? "longitude" : "latitude")) return true;
  if (!described.standard_name.empty()) return false;
  const std::string name = absl::AsciiStrToLower(described.name);
  return (east ? IsNamed(name, {"lon", "clon", "longitude", "loncell"})
               : IsNamed(name, {"lat", "clat", "latitude", "latcell"})) ||
         DirectionOf({"", "", described.units, "", ""}) == direction;
}

// Returns the variable with a coordinate for each cell, whose only dimension is that of the cells.
// Variables that the field lists are preferred.
std::optional<CellCoordinate> FindCoordinate(const netcdf::NetcdfFile& file,
                                             const std::string& field, const std::string& dimension,
                                             CfDirection direction) {
  const std::vector<std::string> listed = NamesIn(file.TextOrEmpty(field, "coordinates"));
  std::optional<CellCoordinate> found;
  for (const std::string& name : file.Variables()) {
    const auto on = file.Dimensions(name);
    if (!on.ok() || *on != std::vector<std::string>{dimension}) continue;
    const CfDescription described = DescribeCf(file, name);
    const auto scale = ScaleOf(described, direction);
    if (!HoldsPlaces(described, direction) || !scale.has_value()) continue;
    const bool is_listed = std::ranges::find(listed, name) != listed.end();
    if (!found.has_value() || is_listed) found = CellCoordinate{name, *scale};
    if (is_listed) break;
  }
  return found;
}

absl::StatusOr<std::vector<double>> ReadCoordinate(const netcdf::NetcdfFile& file,
                                                   const CellCoordinate& coordinate) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<double> values, file.ReadDoubles(coordinate.name));
  for (double& value : values) value *= coordinate.scale;
  return values;
}

absl::Status NoPlaces(const netcdf::NetcdfFile& file, const std::string& field,
                      const std::string& dimension) {
  const std::string where =
      IsMpas(file)
          ? "lonCell and latCell, which MPAS writes to its init or static file; add them, for "
            "example with ncks -A -v lonCell,latCell,zgrid INIT_FILE HISTORY_FILE"
          : "longitudes and latitudes of the cells (clon and clat, in radians or degrees), which "
            "the grid file has; add them, for example with cdo setgrid,GRID_FILE";
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": ", field, " lies on the cells '", dimension,
                   "' of an unstructured grid, and the file has no ", where));
}

// Returns the positions of the cells of an idealised MPAS run.
absl::StatusOr<std::vector<glm::dvec2>> ReadPlane(const netcdf::NetcdfFile& file,
                                                  const std::string& dimension) {
  for (const char* name : {"xCell", "yCell"}) {
    const auto on = file.Dimensions(name);
    if (on.ok() && *on == std::vector<std::string>{dimension}) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the cells lie on a plane (on_a_sphere), and the file has no ",
                     name, " on ", dimension, "; add xCell and yCell from the grid file"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> x_m, file.ReadDoubles("xCell"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> y_m, file.ReadDoubles("yCell"));
  std::vector<glm::dvec2> plane_m;
  plane_m.reserve(x_m.size());
  for (std::size_t cell = 0; cell < x_m.size(); ++cell) plane_m.emplace_back(x_m[cell], y_m[cell]);
  return plane_m;
}

absl::StatusOr<EvenColumns> PlaceOnEarth(const netcdf::NetcdfFile& file, const std::string& field,
                                         const std::string& dimension,
                                         std::vector<std::string>& assumptions) {
  const auto longitude = FindCoordinate(file, field, dimension, CfDirection::kX);
  const auto latitude = FindCoordinate(file, field, dimension, CfDirection::kY);
  if (!longitude.has_value() || !latitude.has_value()) return NoPlaces(file, field, dimension);
  CellPlaces places;
  places.radius_m = kCfEarthRadius_m;
  if (const auto radius_m = file.NumberAttribute("", "sphere_radius");
      radius_m.has_value() && *radius_m > 1e6 && *radius_m < 1e7) {
    places.radius_m = *radius_m;
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(places.longitude_deg, ReadCoordinate(file, *longitude));
  THUNDERHEAD_ASSIGN_OR_RETURN(places.latitude_deg, ReadCoordinate(file, *latitude));
  THUNDERHEAD_ASSIGN_OR_RETURN(LongitudeOrigin origin,
                               OriginOfLongitudes(file, field, longitude->name));
  for (double& each : places.longitude_deg) each += origin.meridian_deg;
  assumptions = std::move(origin.assumptions);
  absl::StatusOr<EvenColumns> even = MakeEvenOfCells(places);
  if (even.ok()) return even;
  return base::Annotate(even.status(),
                        absl::StrCat(file.Path(), ": ", longitude->name, " and ", latitude->name));
}

}  // namespace

bool IsMpas(const netcdf::NetcdfFile& file) {
  return file.DimensionLength("nCells").has_value() &&
         file.DimensionLength("nVertLevels").has_value();
}

absl::StatusOr<CfPlaces> PlaceCells(const netcdf::NetcdfFile& file, const std::string& field,
                                    const CfDimensions& dimensions) {
  const CfDimension& cells = dimensions.axes[0];
  if (cells.length > kMostCells) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the dimension ", cells.name,
                                                   " has ", cells.length, " cells, and at most ",
                                                   kMostCells, " can be read; cut a region first"));
  }
  const bool on_plane =
      absl::AsciiStrToUpper(
          std::string(absl::StripAsciiWhitespace(file.TextOrEmpty("", "on_a_sphere")))) == "NO";
  EvenColumns even;
  CfPlaces places;
  if (on_plane) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<glm::dvec2> plane_m,
                                 ReadPlane(file, cells.name));
    absl::StatusOr<EvenColumns> of_plane = MakeEvenOfPlane(plane_m);
    if (!of_plane.ok()) return base::Annotate(of_plane.status(), file.Path());
    even = *std::move(of_plane);
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(even, PlaceOnEarth(file, field, cells.name, places.assumptions));
  }
  places.dx_m = even.dx_m;
  places.dy_m = even.dy_m;
  std::ranges::copy(AssumptionsOf(even), std::back_inserter(places.assumptions));
  places.even = std::make_shared<const EvenColumns>(std::move(even));
  return places;
}

}  // namespace thunderhead::storm_files
