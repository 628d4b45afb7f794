// The origin of a CF file's coordinates on Earth by global attributes, as PALM writes them:
// origin_lat, origin_lon, origin_z and rotation_angle.
#pragma once

#include <optional>

#include "netcdf/netcdf_file.h"
#include "storm_files/cf_axes.h"
#include "storm_files/even_columns.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

struct CfOrigin {
  volume::EarthPlace place;   // of the point where x and y are 0
  double rotation_deg = 0.0;  // of the y axis, clockwise from north
};

// Returns the place of the origin, or nothing if the file has none.
std::optional<CfOrigin> ReadCfOrigin(const netcdf::NetcdfFile& file);

// Returns the height above sea level of the point where z is 0, in m, or nothing if the file has no
// origin_z.
std::optional<double> ReadCfOriginHeight_m(const netcdf::NetcdfFile& file);

// Returns the columns at these distances in m from the origin. The y axis points to the north.
ColumnPlaces PlacesFromOrigin(const CfOrigin& origin, const CfAxis& x, const CfAxis& y);

}  // namespace thunderhead::storm_files
