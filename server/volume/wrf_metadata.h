// What a WRF output file says of itself before any field is read: grid, times, fields, place; and
// whether it is fit to be read at all (variables, dimensions, units). Knows no cache and no series.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "physics/hydrometeors.h"
#include "volume/grid.h"
#include "volume/netcdf_file.h"
#include "volume/particle_sizes.h"

namespace thunderhead::volume {

struct WrfMetadata {
  std::string path;
  glm::ivec3 cells{0};  // west-east, south-north, bottom-top
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<absl::Time> times;             // of each record of the file, in the file's order
  std::vector<physics::Hydrometeor> fields;  // in the order of physics::kHydrometeors
  // By physics::IndexOf: what tells the size of that field's particles; no name if nothing does.
  std::array<SizeVariable, physics::kHydrometeorCount> sizes;
  bool has_vapour = false;
  bool has_terrain = false;
  std::string model;                   // "WRF V4.7.1"
  bool idealised = false;              // no place on Earth
  int domain = 1;                      // GRID_ID, counted from 1
  std::string simulation_start;        // as the file writes it; tells runs apart
  std::optional<double> latitude_deg;  // of the middle
  std::optional<double> longitude_deg;
};

// WRF's name of a hydrometeor's mixing ratio, e.g. "QCLOUD".
std::string_view WrfVariableOf(physics::Hydrometeor hydrometeor);

// Reads and checks the metadata of the file at `path`. Errors name the file, the variable and what
// to do.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const std::string& path);

// The same of a file that is open.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const NetcdfFile& file);

}  // namespace thunderhead::volume
