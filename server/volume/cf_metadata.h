// What a CF netCDF file says of itself before any field is read: its axes in metres, its times, its
// hydrometeors or extinction, and the air they are in. Knows no cache and no series.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "volume/cf_axes.h"
#include "volume/cf_names.h"
#include "volume/netcdf_file.h"

namespace thunderhead::volume {

// A variable on x, y and z, in any order.
struct CfVariable {
  std::string name;
  // Where each axis stands among its dimensions; `time` is -1 if it has none.
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

struct CfMetadata {
  std::string path;
  std::array<CfAxis, 3> axes;     // x, y, z
  std::vector<absl::Time> times;  // at least one; year 1 if the file gives none
  std::vector<CfField> fields;    // in the order of physics::kHydrometeors, or the extinction alone
  std::vector<CfAirField> air;    // only what mixing ratios need
  std::optional<std::string> surface;  // height of the ground (m) on y, x
  std::string source;                  // the title or source that the file gives
};

// Whether the file has anything that could be drawn.
bool LooksLikeCf(const NetcdfFile& file);

// Reads and checks the metadata. Errors name the file, the variable and what it lacks.
absl::StatusOr<CfMetadata> ReadCfMetadata(const NetcdfFile& file);

}  // namespace thunderhead::volume
