// Reads the times of a WRF output file.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/wrf_layout.h"

namespace thunderhead::storm_files {

struct WrfTimes {
  std::vector<absl::Time> times;  // one for each record, in the file's order
  std::string run;                // SIMULATION_START_DATE as in the file, or empty
  std::vector<std::string> assumptions;
};

// Reads the valid times from the variable Times, otherwise from XTIME or the coordinate of time,
// which count in their own units. The date 0000-00-00 is that of an idealised run, and is taken as
// 0001-01-01. Returns DATA_LOSS if the file has no times, because its writer may not have finished.
absl::StatusOr<WrfTimes> ReadWrfTimes(const netcdf::NetcdfFile& file, const WrfLayout& layout);

}  // namespace thunderhead::storm_files
