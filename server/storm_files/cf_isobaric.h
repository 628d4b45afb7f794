// The heights of a CF file's pressure levels, which follow from the temperature and from the height
// and pressure of the ground.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_heights.h"

namespace thunderhead::storm_files {

// Returns whether the coordinate holds pressures of the air, in any unit of pressure. The nominal
// pressures of model levels are not pressures of the air.
bool HoldsAirPressure(const netcdf::NetcdfFile& file, const std::string& coordinate);

// Returns the description of heights of pressure levels, with the levels' pressures and the
// pressure of the ground. Returns nothing if the layers are no pressure levels, or if the file
// lacks the height or the pressure of the ground. Adds a sentence to `assumptions`. Errors name the
// file, the coordinate and what is wrong.
absl::StatusOr<std::optional<CfHeights>> ReadIsobaricHeights(
    const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
    const std::optional<CfColumnValue>& terrain, std::vector<std::string>& assumptions);

}  // namespace thunderhead::storm_files
