// Finds where the cells of an unstructured grid in a CF file are: those of ICON, MPAS and others.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_places.h"

namespace thunderhead::storm_files {

// Places the cells of `field` by their longitudes and latitudes. The field lists them as its
// `coordinates`, or they have a standard name or the name that ICON and MPAS give them. The cells
// of an idealised MPAS run lie on a plane. Errors name the file, the variable and what is missing.
absl::StatusOr<CfPlaces> PlaceCells(const netcdf::NetcdfFile& file, const std::string& field,
                                    const CfDimensions& dimensions);

// Returns whether the file has the dimensions of MPAS output.
bool IsMpas(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
