// Knowledge of models' output beyond its attributes: advice if the output lacks a needed variable,
// and whether masses are per kg of dry or of moist air. Files are recognised by the names that a
// model uses.
#pragma once

#include <string>

#include "netcdf/netcdf_file.h"
#include "storm_files/cf_metadata.h"

namespace thunderhead::storm_files {

// Returns what to add to this file so that the density of the air is known, for an error: "DALES
// field dumps do not have ...". Returns an empty text if the file is not known to be a model's.
std::string AdviceOnAir(const netcdf::NetcdfFile& file);

// Returns what to add so that the units of the hydrometeors are known, or an empty text.
std::string AdviceOnUnits(const netcdf::NetcdfFile& file);

// Sets what variables mean by the model that wrote them, where their attributes do not say it. Adds
// sentences to the assumptions.
void ApplyModel(const netcdf::NetcdfFile& file, CfMetadata& metadata);

}  // namespace thunderhead::storm_files
