// Metadata of a CF netCDF file: where its columns and layers are, its times, hydrometeors or
// extinction, and state of the air. This code reads no fields, and does not depend on caches or on
// series of files.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/calendar.h"
#include "storm_files/cf_arrange.h"
#include "storm_files/cf_axes.h"
#include "storm_files/cf_heights.h"
#include "storm_files/cf_names.h"
#include "storm_files/cf_places.h"
#include "storm_files/reference_atmosphere.h"

namespace thunderhead::storm_files {

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
  CfWind wind;
};

struct CfMetadata {
  std::string path;
  std::string heights_path;  // path of the run's file of heights; empty if there is none
  std::string group;         // the group with the fields, e.g. "/les"; empty for the root
  CfDimensions dimensions;
  CfAxis x;
  CfAxis y;
  CfPlaces places;  // at the first record
  // The columns at each record, if they move. A record with the columns of the first has null.
  // Empty if the columns do not move.
  std::vector<std::shared_ptr<const CfPlaces>> moved;
  CfHeights heights;
  CfOrder order;
  // The names of the ensemble's members; empty if the fields have none. `order` says which is read.
  std::vector<std::string> members;
  std::vector<absl::Time> times;             // at least one; in year 1 if the file gives no dates
  std::optional<absl::Time> run_start;       // when the model run began, if the file says so
  Calendar calendar = Calendar::kGregorian;  // of the times
  std::vector<CfField> fields;  // the hydrometeors in the order of physics::kHydrometeors, or
                                // only the extinction
  std::vector<CfAirField> air;  // only the variables that are needed to convert mixing ratios to
                                // mass per volume, or to compute heights
  std::optional<ReferenceAtmosphere> reference;  // of AirVariable::kPressureDeviation
  // Turbulent energy, and either all three components of the wind or none.
  std::vector<CfWindField> wind;
  std::optional<CfColumnValue> terrain;
  std::string source;                    // the file's title, or else its `source` attribute
  std::vector<std::string> assumptions;  // sentences for the user
};

// Returns whether the file has a variable whose name or standard name is that of a quantity that
// can be drawn, in the root or in a group.
bool LooksLikeCf(const netcdf::NetcdfFile& file);

// Reads and checks the metadata. `heights_file` has the heights of layers and of the ground if
// `file` lacks them, or is null. Errors name the file, the variable and what is missing.
absl::StatusOr<CfMetadata> ReadCfMetadata(const netcdf::NetcdfFile& file,
                                          const netcdf::NetcdfFile* heights_file = nullptr);

}  // namespace thunderhead::storm_files
