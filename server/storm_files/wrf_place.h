// Reads where the domain of a WRF output file is on Earth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/wrf_layout.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

struct WrfPlace {
  bool idealised = false;                    // true if the run has no place on Earth
  std::optional<volume::EarthPlace> middle;  // of the domain at the first time; nothing if unknown
  // The middle of the domain at each time, if the domain moves. Otherwise empty.
  std::vector<volume::EarthPlace> middles;
  std::string latitude;    // the variable of the columns' latitudes; empty if none is used
  std::string longitude;   // the variable of the columns' longitudes; empty if none is used
  std::string projection;  // as a PROJ string; empty if the grid has no projection
  std::vector<std::string> projections;  // at each time, if the domain moves; otherwise empty
  std::vector<std::string> assumptions;
};

// Reads the place from XLAT and XLONG, which may have no time. Without these variables, takes the
// place from the attributes CEN_LAT and CEN_LON, if the file has the whole outermost domain.
// Returns INVALID_ARGUMENT if XLAT or XLONG do not have one value for each column.
absl::StatusOr<WrfPlace> ReadWrfPlace(const netcdf::NetcdfFile& file, const WrfLayout& layout);

// Returns the projection of the grid as PROJ writes it, on WRF's sphere. Returns an empty text if
// the attributes do not give it, or if the grid is in degrees instead of metres.
std::string WrfProjectionOf(const netcdf::NetcdfFile& file);

// Returns GRID_ID, the number of the nested domain, counted from 1.
int DomainOf(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
