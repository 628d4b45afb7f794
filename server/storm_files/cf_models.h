// Advice for output of models that lacks what is needed, by the names that a model uses. Files are
// read by their meaning, and never by the model.
#pragma once

#include <string>

#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {

// Returns what to add to this file so that the density of the air is known, for an error: "DALES
// field dumps lack ...". Returns an empty text if the file is not known to be a model's.
std::string AdviceOnAir(const netcdf::NetcdfFile& file);

// Returns what to add so that the units of the hydrometeors are known, or an empty text.
std::string AdviceOnUnits(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
