#include "storm_files/cf_mapping.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "storm_files/cf_arrange.h"

namespace thunderhead::storm_files {

CfMapping MappingOf(const netcdf::NetcdfFile& file, const std::string& field,
                    const std::string& coordinate) {
  CfMapping mapping;
  std::string current;
  for (const std::string& word : NamesIn(file.TextOrEmpty(field, "grid_mapping"))) {
    const bool names_mapping = current.empty() || absl::EndsWith(word, ":");
    if (names_mapping) {
      current = std::string(absl::StripSuffix(word, ":"));
      if (mapping.name.empty()) mapping.name = current;
    } else if (word == coordinate) {
      mapping.name = current;
      mapping.lists_coordinate = true;
      break;
    }
  }
  mapping.exists = !mapping.name.empty() && file.HasVariable(mapping.name);
  if (!mapping.exists) return mapping;
  for (const std::string& attribute : file.AttributesOf(mapping.name)) {
    if (auto text = file.TextAttribute(mapping.name, attribute); text.has_value()) {
      mapping.attributes[attribute] = *std::move(text);
    } else if (auto numbers = file.NumbersAttribute(mapping.name, attribute); !numbers.empty()) {
      mapping.attributes[attribute] = std::move(numbers);
    }
  }
  return mapping;
}

absl::Status BadMapping(const netcdf::NetcdfFile& file, const CfMapping& mapping,
                        const absl::Status& problem) {
  return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the grid mapping ", mapping.name,
                                                 " ", std::string(problem.message())));
}

absl::StatusOr<double> PrimeMeridianOf(const netcdf::NetcdfFile& file, const CfMapping& mapping) {
  auto meridian_deg = PrimeMeridianOf(mapping.attributes);
  if (meridian_deg.ok()) return meridian_deg;
  return BadMapping(file, mapping, meridian_deg.status());
}

std::string MeridianSentence(const std::string& longitude, const CfMapping& mapping,
                             double meridian_deg) {
  return absl::StrFormat(
      "The longitudes %s count from the prime meridian of the grid mapping %s, %.6g degrees east "
      "of Greenwich.",
      longitude, mapping.name, meridian_deg);
}

absl::StatusOr<LongitudeOrigin> OriginOfLongitudes(const netcdf::NetcdfFile& file,
                                                   const std::string& field,
                                                   const std::string& longitude) {
  LongitudeOrigin origin;
  const CfMapping mapping = MappingOf(file, field, longitude);
  if (!mapping.exists) return origin;
  const std::string kind = file.TextOrEmpty(mapping.name, "grid_mapping_name");
  // A well-known text that is no projection is a system of longitudes and latitudes.
  const bool maps_longitudes =
      mapping.lists_coordinate || kind == "latitude_longitude" ||
      (kind.empty() && !ReadGridMapping(mapping.attributes, MappedGrid()).ok());
  if (!maps_longitudes) return origin;
  THUNDERHEAD_ASSIGN_OR_RETURN(origin.meridian_deg, PrimeMeridianOf(file, mapping));
  if (origin.meridian_deg != 0.0) {
    origin.assumptions.push_back(MeridianSentence(longitude, mapping, origin.meridian_deg));
  }
  return origin;
}

}  // namespace thunderhead::storm_files
