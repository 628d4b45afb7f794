#include "storm_files/cf_angles.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "storm_files/cf_mapping.h"
#include "storm_files/grid_mapping.h"

namespace thunderhead::storm_files {
namespace {

enum class AngleOf { kEarth, kRotatedGrid, kMap, kUnknown };

bool IsAnyOf(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

// Returns what an axis of angles says about itself.
AngleOf WhatAxisSays(const netcdf::NetcdfFile& file, const CfAxis& axis) {
  const CfDescription described = DescribeCf(file, axis.coordinate);
  const std::string& standard = described.standard_name;
  if (IsAnyOf(standard, {"longitude", "latitude"})) return AngleOf::kEarth;
  if (absl::StartsWith(standard, "grid_")) return AngleOf::kRotatedGrid;
  if (absl::StartsWith(standard, "projection_")) return AngleOf::kMap;
  // Programs add numbers and words to names, as in lon_2.
  const std::string lower = absl::AsciiStrToLower(described.name);
  const std::string name = lower.substr(0, lower.find_first_of("_0123456789"));
  // Some programs write degrees_east for rotated longitudes.
  if (IsAnyOf(name, {"rlon", "rlat"})) return AngleOf::kRotatedGrid;
  // Only units without a direction are units of both axes.
  const bool has_direction = DegreesIn(described.units, CfDirection::kX).has_value() !=
                             DegreesIn(described.units, CfDirection::kY).has_value();
  const bool is_named =
      IsAnyOf(name, {"lon", "lat", "longitude", "latitude"}) ||
      IsAnyOf(absl::AsciiStrToLower(described.long_name), {"longitude", "latitude"});
  return has_direction || is_named ? AngleOf::kEarth : AngleOf::kUnknown;
}

// Returns what the field's grid mapping says about the angles along x and y.
AngleOf WhatMappingSays(const netcdf::NetcdfFile& file, const std::string& field, const CfAxis& x) {
  const CfMapping mapping = MappingOf(file, field, x.coordinate);
  if (!mapping.exists) return AngleOf::kUnknown;
  const std::string kind = file.TextOrEmpty(mapping.name, "grid_mapping_name");
  if (absl::StartsWith(kind, "rotated_")) return AngleOf::kRotatedGrid;
  if (kind == "latitude_longitude") return AngleOf::kEarth;
  if (!kind.empty() || ReadGridMapping(mapping.attributes, MappedGrid()).ok()) return AngleOf::kMap;
  // A well-known text that is no projection is a system of longitudes and latitudes.
  const bool has_text =
      mapping.attributes.contains("crs_wkt") || mapping.attributes.contains("spatial_ref");
  return has_text ? AngleOf::kEarth : AngleOf::kUnknown;
}

bool AreScanningAngles(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y) {
  return WhatAxisSays(file, x) == AngleOf::kMap || WhatAxisSays(file, y) == AngleOf::kMap;
}

bool AreRotated(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y) {
  return WhatAxisSays(file, x) == AngleOf::kRotatedGrid ||
         WhatAxisSays(file, y) == AngleOf::kRotatedGrid;
}

}  // namespace

bool AreEarthAngles(const netcdf::NetcdfFile& file, const std::string& field, const CfAxis& x,
                    const CfAxis& y) {
  if (x.unit != CfAxisUnit::kDegrees || y.unit != CfAxisUnit::kDegrees) return false;
  if (AreRotated(file, x, y) || AreScanningAngles(file, x, y)) return false;
  const AngleOf mapping = WhatMappingSays(file, field, x);
  if (mapping == AngleOf::kRotatedGrid) return false;
  return mapping == AngleOf::kEarth || WhatAxisSays(file, x) == AngleOf::kEarth ||
         WhatAxisSays(file, y) == AngleOf::kEarth;
}

absl::Status CheckAnglesHaveLength(const netcdf::NetcdfFile& file, const CfAxis& x,
                                   const CfAxis& y) {
  const bool in_degrees = x.units_per_written == 1.0 && y.units_per_written == 1.0;
  const bool has_length = AreRotated(file, x, y) || (in_degrees && !AreScanningAngles(file, x, y));
  if (has_length) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", x.coordinate, " and ", y.coordinate, " are angles in '",
      file.TextOrEmpty(x.coordinate, "units"),
      "', and neither their names nor a grid mapping say of what, so the cells have no size; add "
      "the satellite's grid_mapping (geostationary), the standard names longitude and latitude, or "
      "longitudes and latitudes of all columns"));
}

std::string WhyAnglesAreNoPlace(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y) {
  if (AreRotated(file, x, y)) {
    return absl::StrCat(
        "The place is not known, because ", x.coordinate, " and ", y.coordinate,
        " are those of a rotated grid, and the file has no grid mapping and no longitudes and "
        "latitudes.");
  }
  return absl::StrCat(
      "The place is not known, because ", x.coordinate, " and ", y.coordinate,
      " are in degrees and do not say that they are longitudes and latitudes. If they are, give "
      "them these standard names.");
}

}  // namespace thunderhead::storm_files
