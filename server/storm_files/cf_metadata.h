// Metadata of a CF netCDF file: its axes in metres, times, hydrometeors or extinction, and state of
// the air. This code reads no fields, and does not depend on caches or on series of files.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_axes.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// A variable on x, y and z, in any order.
struct CfVariable {
  std::string name;
  // The index of each axis among the variable's dimensions. `time` is -1 if the variable has no
  // time axis.
  int x = -1;
  int y = -1;
  int z = -1;
  int time = -1;
  int dimensions = 0;
};

struct CfField {
  CfVariable variable;
  CfQuantity quantity;
};

struct CfAirField {
  CfVariable variable;
  CfAir air;
};

struct CfWindField {
  CfVariable variable;
  WindVariable wind;
};

// The variable with the height of the ground, which has the dimensions y and x.
struct CfSurface {
  std::string variable;
  double metres = 1.0;  // length in metres of one unit of the variable
};

// The radius of the sphere on which degrees are converted to metres.
inline constexpr double kCfEarthRadius_m = 6.371e6;

struct CfMetadata {
  std::string path;
  std::array<CfAxis, 3> axes;     // x, y, z
  std::vector<absl::Time> times;  // at least one; in year 1 if the file gives no dates
  std::vector<CfField> fields;    // the hydrometeors in the order of physics::kHydrometeors, or
                                  // only the extinction
  std::vector<CfAirField> air;    // only the variables that are needed to convert mixing ratios to
                                  // mass per volume
  // Turbulent energy, and either all three components of the wind or none.
  std::vector<CfWindField> wind;
  std::optional<CfSurface> surface;
  std::string source;  // the file's title, or else its `source` attribute
};

// Returns whether the file has a variable whose name or standard name is that of a quantity that
// can be drawn.
bool LooksLikeCf(const netcdf::NetcdfFile& file);

// Reads and checks the metadata. Errors name the file, the variable and what is missing.
absl::StatusOr<CfMetadata> ReadCfMetadata(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
