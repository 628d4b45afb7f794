// Finds where the columns of a CF file are on Earth, and how far apart they are.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_axes.h"
#include "storm_files/even_columns.h"

namespace thunderhead::storm_files {

// The radius of the sphere on which degrees are converted to metres, unless a grid mapping has
// another.
inline constexpr double kCfEarthRadius_m = 6.371e6;

struct CfPlaces {
  double dx_m = 0.0;  // distance between neighbouring columns along x (ModelSpacing_m of `even`)
  double dy_m = 0.0;
  // The columns of the storm, even in true metres. Null for an idealised run, whose own columns are
  // even.
  std::shared_ptr<const EvenColumns> even;
  // The columns by their latitudes and longitudes, if these depend on time. Otherwise null.
  std::shared_ptr<const ColumnPlaces> listed;
  std::vector<std::string> assumptions;  // sentences for the user
};

// A time at which columns are placed.
struct CfPlacing {
  std::size_t record = 0;
  std::optional<glm::ivec2> columns;  // as EvenOptions::columns
};

// Places the columns of `field` by the axes' coordinates, the field's grid mapping, and arrays of
// latitude and longitude on y and x. Sets the direction of axes without coordinates. Errors name
// the file, the variable and what is wrong.
absl::StatusOr<CfPlaces> PlaceColumns(const netcdf::NetcdfFile& file, const std::string& field,
                                      const CfDimensions& dimensions, const CfPlacing& at,
                                      CfAxis& x, CfAxis& y);

// Returns the places at a record of the file if they differ from `first`, those of the first
// record. Returns nothing if they are the same.
absl::StatusOr<std::optional<CfPlaces>> PlaceColumnsAgain(const netcdf::NetcdfFile& file,
                                                          const std::string& field,
                                                          const CfDimensions& dimensions,
                                                          const CfPlaces& first, std::size_t record,
                                                          CfAxis x, CfAxis y);

}  // namespace thunderhead::storm_files
