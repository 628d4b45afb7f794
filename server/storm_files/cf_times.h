// Reads the times of a CF file: from a coordinate along a dimension, an auxiliary coordinate or a
// scalar one, in any calendar of CF.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/calendar.h"

namespace thunderhead::storm_files {

struct CfTimes {
  std::vector<absl::Time> times;         // one for each record; in year 1 if the file has no dates
  std::vector<std::string> assumptions;  // sentences for the user
  // The forecast_reference_time, which is when the model run began. It is absent if the file has
  // none, or several.
  std::optional<absl::Time> run_start;
  Calendar calendar = Calendar::kGregorian;  // of the dates of all these times
};

// Reads the times of a variable. `dimension` is the name of its time dimension, or empty if it has
// none. Errors name the file, the variable and what is wrong.
absl::StatusOr<CfTimes> ReadCfTimes(const netcdf::NetcdfFile& file, const std::string& variable,
                                    const std::string& dimension);

// Decodes values of a time coordinate with these `units` and this `calendar` attribute. An error
// says what is wrong, without the file's name.
absl::StatusOr<std::vector<absl::Time>> DecodeCfTimes(const std::vector<double>& values,
                                                      const std::string& units,
                                                      const std::string& calendar);

}  // namespace thunderhead::storm_files
