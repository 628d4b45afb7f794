// Metadata of a WRF output file: grid, times, fields and place on Earth. Reading it also checks the
// variables, dimensions and units that the reader needs. This code reads no fields, and does not
// depend on caches or on series of files.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "physics/hydrometeors.h"
#include "physics/size_distributions.h"
#include "storm_files/even_columns.h"
#include "storm_files/wrf_columns.h"
#include "storm_files/wrf_land.h"
#include "storm_files/wrf_layout.h"
#include "storm_files/wrf_phases.h"
#include "storm_files/wrf_place.h"
#include "volume/grid.h"
#include "volume/particle_sizes.h"

namespace thunderhead::storm_files {

// A variable that gives a quantity in SI units: its values times `scale`, plus `offset`.
struct WrfTerm {
  std::string variable;  // empty if the file has none
  double scale = 1.0;
  double offset = 0.0;
  bool per_level = false;  // true if the variable has one value for each level
};

// The variables of the layers' heights.
struct WrfHeights {
  // Perturbation and base of the geopotential at the interfaces (m2/s2). Their names are empty if
  // the file has heights of the layers' middles instead.
  std::string perturbation;
  std::string base;
  WrfTerm middles;  // height above sea level (m)
};

// The variables of the air's state. The pressure (Pa) is the sum of its terms.
struct WrfAir {
  std::vector<WrfTerm> pressure;
  WrfTerm temperature;     // (K)
  bool potential = false;  // true if `temperature` is the potential temperature
  // True if the potential temperature is that of moist air: theta (1 + Rv / Rd q_v).
  bool moist = false;
  bool has_vapour = false;
};

struct WrfMetadata {
  std::string path;
  WrfLayout layout;
  glm::ivec3 cells{0};  // west-east, south-north, bottom-top
  // Mean true distances between neighbouring columns at the first record. They are the attributes
  // DX and DY if the columns have no place on Earth.
  double dx_m = 0.0;
  double dy_m = 0.0;
  glm::dvec2 on_map_m{0.0};  // the attributes DX and DY, which are lengths on the model's map
  // The attributes DX and DY. If the places of the columns are not known, they are divided by the
  // map factors.
  glm::dvec2 nominal_m{0.0};
  WrfColumnNames columns;
  ColumnPlaces places;                       // at the first record
  std::shared_ptr<const EvenColumns> even;   // at the first record; null without a place on Earth
  std::vector<absl::Time> times;             // one for each record, in the file's order
  std::vector<physics::Hydrometeor> fields;  // in the order of physics::kHydrometeors
  // The variable of each field, and the variable of its particles' sizes, indexed by
  // physics::IndexOf. A name is empty if the file has no such variable.
  std::array<std::string, physics::kHydrometeorCount> variables;
  std::array<volume::SizeVariable, physics::kHydrometeorCount> sizes;
  // Further categories of cloud ice, which are added to the first.
  std::vector<std::string> more_ice;
  // How the variables that two fields share are split.
  PhaseSplit split = PhaseSplit::kNone;
  physics::Microphysics microphysics = physics::Microphysics::kUnknown;
  WrfHeights heights;
  WrfAir air;
  // The variable of turbulent kinetic energy, without a name if there is none. Boundary layer
  // schemes may write it on interfaces or doubled.
  struct Energy {
    std::string name;
    bool at_interfaces = false;
    bool doubled = false;
  };
  Energy energy;
  std::array<std::string, 3> wind;  // the variables of the wind; the names are empty if one is
                                    // missing
  bool has_terrain = false;
  WrfLand land;                  // all names are empty for an idealised run
  std::string model;             // "WRF V4.7.1"
  int domain = 1;                // GRID_ID, counted from 1
  std::string simulation_start;  // SIMULATION_START_DATE as in the file; differs between runs
  WrfPlace place;
  std::vector<std::string> assumptions;  // for users; each text is one sentence

  // Returns the distances between columns along x and y. They are DX and DY if `even_at_record` is
  // null or agrees with DX and DY to the accuracy of places, and otherwise those of
  // `even_at_record`.
  glm::dvec2 DistancesOf(const EvenColumns* even_at_record) const;

  // Returns whether another field comes from the same variable.
  bool IsShared(physics::Hydrometeor hydrometeor) const;
};

// Returns WRF's name of a hydrometeor's mixing ratio, e.g. "QCLOUD".
std::string_view WrfVariableOf(physics::Hydrometeor hydrometeor);

// Reads and checks the metadata of the file at `path`. Errors name the file, the variable and what
// to do.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const std::string& path);

// Reads and checks the metadata of a file that is already open, with the same errors.
absl::StatusOr<WrfMetadata> ReadWrfMetadata(const netcdf::NetcdfFile& file);

// Returns the even columns at a record of `file`, which has this metadata. A domain that moves (a
// moving nest) has other distances and another projection at each record, but always the same
// number of columns. Returns null without a place on Earth.
absl::StatusOr<std::shared_ptr<const EvenColumns>> EvenColumnsAt(const WrfMetadata& metadata,
                                                                 const netcdf::NetcdfFile& file,
                                                                 std::size_t record);

}  // namespace thunderhead::storm_files
