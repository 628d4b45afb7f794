// Reads where the columns of a WRF file are on Earth.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/even_columns.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// The variables of the columns' places, and the map projection in PROJ's notation. The projection
// may be empty.
struct WrfColumnNames {
  std::string latitude = "XLAT";
  std::string longitude = "XLONG";
  std::string projection;
};

// Reads the places of `columns` columns at a record. The variables may lack the time. If the places
// are evenly spaced in the projection, returns them as even steps in its plane. The steps are
// measured between the places. The attributes DX and DY are not used, because they stay as they are
// if a program keeps only every second column. Returns nothing if the file does not have one place
// for each column, or if the domain is so small that places stored as floats do not give its size.
absl::StatusOr<std::optional<ColumnPlaces>> ReadWrfColumns(const netcdf::NetcdfFile& file,
                                                           const WrfColumnNames& names,
                                                           const glm::ivec2& columns,
                                                           std::size_t record);

// Lengths on the model's map divided by true lengths.
struct WrfMapFactors {
  glm::dvec2 factors{1.0};  // along x and along y
  std::string from;         // where they come from, for users: "the mean map factor 2"
};

// Returns the means of MAPFAC_MX and MAPFAC_MY over all columns at the first time, or that of
// MAPFAC_M for an axis without one. If the file has no usable map factor, returns those of its
// projection (MAP_PROJ) at the latitude of `middle` or, if that is unknown, at CEN_LAT. Returns
// nothing if these are unknown, too.
absl::StatusOr<std::optional<WrfMapFactors>> FindMapFactors(
    const netcdf::NetcdfFile& file, const glm::ivec2& columns,
    const std::optional<volume::EarthPlace>& middle);

}  // namespace thunderhead::storm_files
