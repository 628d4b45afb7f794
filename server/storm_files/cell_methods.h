// The attribute cell_methods (CF, section 7.3). It says how a variable's values represent their
// cells and times. A mean, a maximum or a variance over a time is no value at that time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {

// The meaning of a text of cell_methods for an amount of water in a cell.
enum class CellMethod {
  kValue,      // the cell's own amount, at one time
  kStatistic,  // an amount that is not the cell's own at one time: a mean over a time, a maximum
  kNoAmount,   // a variance, a standard deviation, a range or a sum
};

// Returns the meaning of the method that changes a value most. An empty text means a value.
CellMethod MeaningOfCellMethods(std::string_view cell_methods);

// Returns whether the variable's cell_methods say that its values are no amounts.
bool HoldsNoAmount(const netcdf::NetcdfFile& file, const std::string& variable);

// Returns INVALID_ARGUMENT, which names the variable, if one of the variables holds no amounts. If
// values are a statistic, adds one sentence to `assumptions` for all variables with the same
// method.
absl::Status CheckCellMethods(const netcdf::NetcdfFile& file,
                              const std::vector<std::string>& variables,
                              std::vector<std::string>& assumptions);

// Returns INVALID_ARGUMENT, which names the variable, if packing makes the amounts of a variable
// negative: its scale_factor is below 0, and its add_offset is not above 0. If a scale_factor is 0,
// adds a sentence to `assumptions`, because all amounts are then the same.
absl::Status CheckScaleFactors(const netcdf::NetcdfFile& file,
                               const std::vector<std::string>& variables,
                               std::vector<std::string>& assumptions);

}  // namespace thunderhead::storm_files
