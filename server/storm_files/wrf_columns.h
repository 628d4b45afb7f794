// Reads where the columns of a WRF file are on Earth.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/even_columns.h"

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

// Returns the mean map factor (MAPFAC_M) of the columns at the first time: a length on the model's
// map divided by the true length. Returns 1 if the file has none, or one that is not positive.
absl::StatusOr<double> ReadMeanMapFactor(const netcdf::NetcdfFile& file, const glm::ivec2& columns);

}  // namespace thunderhead::storm_files
