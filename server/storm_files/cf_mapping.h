// The grid mapping of a CF file's field (CF-1.8, section 5.6), and the meridian from which its
// longitudes count.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/grid_mapping.h"

namespace thunderhead::storm_files {

struct CfMapping {
  std::string name;               // name of the mapping's variable; empty if the field names none
  bool exists = false;            // whether the file has the variable
  bool lists_coordinate = false;  // whether the field says that the mapping is for this coordinate
  Attributes attributes;
};

// Returns the grid mapping of the field's coordinate variable `coordinate`. A field may name
// several mappings, each with the coordinates that it maps ("crs: x y wgs84: lat lon"). If none of
// them has this coordinate, the first is returned.
CfMapping MappingOf(const netcdf::NetcdfFile& file, const std::string& field,
                    const std::string& coordinate);

// Returns an error that says what is wrong with a mapping's attributes.
absl::Status BadMapping(const netcdf::NetcdfFile& file, const CfMapping& mapping,
                        const absl::Status& problem);

// Returns the longitude of the mapping's prime meridian in degrees east of Greenwich, or 0 if there
// is no mapping. Errors name the file, the mapping and the attribute.
absl::StatusOr<double> PrimeMeridianOf(const netcdf::NetcdfFile& file, const CfMapping& mapping);

// Returns a sentence for the user about longitudes that do not count from Greenwich.
std::string MeridianSentence(const std::string& longitude, const CfMapping& mapping,
                             double meridian_deg);

struct LongitudeOrigin {
  double meridian_deg = 0.0;  // where the longitudes count from, in degrees east of Greenwich
  std::vector<std::string> assumptions;  // sentences for the user
};

// Returns from where the auxiliary variable `longitude` counts, which has a value for each column.
// That is the prime meridian of its mapping, if the mapping is named for this variable or is one of
// longitudes and latitudes. Otherwise the field's mapping is that of other coordinates, and the
// longitudes count from Greenwich. Errors are those of PrimeMeridianOf.
absl::StatusOr<LongitudeOrigin> OriginOfLongitudes(const netcdf::NetcdfFile& file,
                                                   const std::string& field,
                                                   const std::string& longitude);

}  // namespace thunderhead::storm_files
