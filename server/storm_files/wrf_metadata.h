// Metadata of a WRF output file: grid, times, fields and place on Earth. Reading it also checks the
// variables, dimensions and units that the reader needs. This code reads no fields, and does not
// depend on caches or on series of files.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "physics/hydrometeors.h"
#include "physics/land_use.h"
#include "physics/size_distributions.h"
#include "storm_files/even_columns.h"
#include "storm_files/wrf_columns.h"
#include "volume/grid.h"
#include "volume/particle_sizes.h"

namespace thunderhead::storm_files {

// The names of the land-cover variables. A name is empty if the file lacks the variable.
struct WrfLand {
  physics::LandUseScheme scheme = physics::LandUseScheme::kUsgs;
  std::string land_use;
  std::string mask;  // XLAND (2 is water) or LANDMASK (0 is water)
  std::string albedo;
  std::string green;       // variable in percent
  std::string snow_share;  // variable with the snow-covered share of a cell
  std::string snow_depth;  // variable with the depth in m, used if there is no share
};

struct WrfMetadata {
  std::string path;
  glm::ivec3 cells{0};  // west-east, south-north, bottom-top
  double dx_m = 0.0;  // mean true distances between neighbouring columns; the attributes DX and DY
  double dy_m = 0.0;  // if the columns have no place on Earth
  glm::dvec2 nominal_m{0.0};  // the attributes DX and DY, which are lengths on the model's map
  WrfColumnNames columns;
  ColumnPlaces places;                       // at the first record
  std::shared_ptr<const EvenColumns> even;   // at the first record; null without a place on Earth
  std::vector<absl::Time> times;             // one for each record, in the file's order
  std::vector<physics::Hydrometeor> fields;  // in the order of physics::kHydrometeors
  // The variable of each field's particle sizes, indexed by physics::IndexOf. Its name is empty if
  // the file has no such variable.
  std::array<volume::SizeVariable, physics::kHydrometeorCount> sizes;
  physics::Microphysics microphysics = physics::Microphysics::kUnknown;
  // The variable of turbulent kinetic energy, without a name if there is none. Boundary layer
  // schemes may write it on interfaces or doubled.
  struct Energy {
    std::string name;
    bool at_interfaces = false;
    bool doubled = false;
  };
  Energy energy;
  bool has_wind = false;  // true if the file has U, V and W
  bool has_vapour = false;
  bool has_terrain = false;
  WrfLand land;                        // all names are empty for an idealised run
  std::string model;                   // "WRF V4.7.1"
  bool idealised = false;              // true if the run has no place on Earth
  int domain = 1;                      // GRID_ID, counted from 1
  std::string simulation_start;        // SIMULATION_START_DATE as in the file; differs between runs
  std::optional<double> latitude_deg;  // latitude of the middle of the domain
  std::optional<double> longitude_deg;
  std::string projection;  // as a PROJ string; empty if the grid has no projection
};

// Returns WRF's name of a hydrometeor's mixing ratio, e.g. "QCLOUD".
std::string_view WrfVariableOf(physics::Hydrometeor hydrometeor);

// Reads and checks the metadata of the file at `path`. Errors name the file, the variable and what
// to do.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const std::string& path);

// Does the same for a file that is already open.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const netcdf::NetcdfFile& file);

}  // namespace thunderhead::storm_files
