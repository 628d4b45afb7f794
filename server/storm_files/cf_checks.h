// Checks of the variables of a CF file that several parts of its metadata share.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_metadata.h"

namespace thunderhead::storm_files {

// Returns INVALID_ARGUMENT, which names the variable, its units and the required units.
absl::Status WrongUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                        const std::string& wanted);

// Returns the number of dimensions, without time, of a variable on all axes.
std::size_t RankOf(const CfMetadata& metadata);

// Returns whether a variable of the air was found.
bool Has(const CfMetadata& metadata, AirVariable variable);

// Returns whether the variable lies on x, y and z.
bool OnAllAxes(const CfVariable& variable);

// Returns whether the variable lies on the cells, not on the faces between them.
bool OnCells(const CfVariable& variable);

// Returns how a variable lies on the fields' cells. An error says why it cannot be used.
absl::StatusOr<CfVariable> ArrangeOnCells(const netcdf::NetcdfFile& file,
                                          const std::string& variable, const CfMetadata& metadata);

// Returns whether a variable lies on x, y and z. It may also have other dimensions, such as bins.
bool LiesOnAllAxes(const netcdf::NetcdfFile& file, const std::string& variable,
                   const CfMetadata& metadata);

// Returns whether a variable lacks an axis, like a column total or a profile.
bool HasFewerAxes(const netcdf::NetcdfFile& file, const std::string& variable,
                  const CfMetadata& metadata);

}  // namespace thunderhead::storm_files
