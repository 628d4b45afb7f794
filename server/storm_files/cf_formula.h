// The heights of layers that follow from a formula: the parametric coordinates of CF (appendix D)
// and of models that write no formula_terms.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_heights.h"

namespace thunderhead::storm_files {

// Returns an error that names the vertical coordinate, why it has no heights, and what to add.
absl::Status NoCfHeights(const netcdf::NetcdfFile& file, const std::string& name,
                         const std::string& why);

// Returns the heights of layers with a parametric coordinate. Returns nothing if the file has none.
// `terrain` is the file's height of the ground. Adds sentences to `assumptions`. Errors name the
// file, the coordinate and what is missing.
absl::StatusOr<std::optional<CfHeights>> ReadFormulaHeights(
    const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
    const std::optional<CfColumnValue>& terrain, std::vector<std::string>& assumptions);

// Returns the heights of CM1's layers over terrain: z = zs + s (ztop - zs) / ztop, where s is the
// nominal height. Returns nothing if the file is not CM1's, or if its ground is flat at height 0.
absl::StatusOr<std::optional<CfHeights>> ReadCm1Heights(const netcdf::NetcdfFile& file,
                                                        const CfDimensions& dimensions,
                                                        const std::optional<CfColumnValue>& terrain,
                                                        std::vector<std::string>& assumptions);

}  // namespace thunderhead::storm_files
