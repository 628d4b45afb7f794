// Finds the fields of each time of a storm in the indexes of GRIB files. They are the needed
// fields, on the levels that all of these share. Other fields give the heights of the levels. This
// code decodes no data.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grib/grid.h"
#include "grib/index.h"
#include "physics/hydrometeors.h"
#include "storm_files/grib_parameters.h"

namespace thunderhead::storm_files {

// A field of one of several files. The files' indexes own the field.
struct GribPlace {
  std::size_t file = 0;
  const grib::Field* field = nullptr;  // null where a level lacks the field
};

// One field on all levels, in the order of GribLayers::levels. It is empty if the file has none.
struct GribSeries {
  GribKind kind = GribKind::kNone;
  std::string name;
  bool on_half_levels = false;  // if true, `levels` has one level more than GribLayers::levels
  std::vector<GribPlace> levels;

  bool Empty() const { return levels.empty(); }
};

struct GribHydrometeor {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  volume::Quantity quantity = volume::Quantity::kMixingRatio;
  AirMass per = AirMass::kDry;
  GribSeries amounts;
  GribSeries numbers;
  // True if `amounts` hold liquid and ice together. Temperature decides which part is this
  // hydrometeor.
  bool is_split = false;
};

// The source of the heights of levels.
enum class GribVertical {
  kHeights,      // the height of each level
  kHalfHeights,  // the heights of the half levels between them (ICON's HHL)
  kHydrostatic,  // the coefficients of hybrid levels, surface pressure, temperature and humidity
  kIsobaric,     // levels of one pressure each, with their heights
};

struct GribLayers {
  absl::Time time;
  GribVertical vertical = GribVertical::kHeights;
  // Isobaric levels in Pa from the ground upwards, or numbers of model levels in ascending order,
  // which may be downwards.
  std::vector<double> levels;
  std::vector<GribHydrometeor> hydrometeors;  // in the order of physics::kHydrometeors
  GribSeries heights;                         // not for kHydrostatic
  GribSeries pressure;                        // only for kHeights and kHalfHeights
  GribSeries temperature;
  GribSeries humidity;
  GribSeries wind_x;
  GribSeries wind_y;
  GribSeries ascent;
  GribSeries energy;
  GribSeries surface_height;    // has one level, like the series down to green_cover
  GribSeries surface_pressure;  // kPressure or kLogPressure
  GribSeries land_use;          // empty if its classes are unknown
  GribSeries land_share;
  GribSeries snow_cover;
  GribSeries albedo;
  GribSeries green_cover;
  std::vector<float> half_level_coefficients;  // for kHydrostatic: all a, then all b

  bool HasWind() const { return !wind_x.Empty() && !wind_y.Empty() && !ascent.Empty(); }
};

// The contents of the GRIB files of one run and member.
struct GribContents {
  std::string path;               // of the storm, for errors
  std::vector<GribLayers> times;  // in ascending order
  grib::Grid grid;
  GribPlace cell_latitude;  // this and cell_longitude: only for an unstructured grid
  GribPlace cell_longitude;
  grib::Origin origin;
  int process = 0;
  std::string member;      // empty if the files have no members
  std::string level_kind;  // "hybrid levels"
  GribModel model;
  std::vector<std::string> assumptions;  // each one sentence
};

using GribIndexes = std::vector<std::shared_ptr<const grib::Index>>;

// Finds the storms in the files, one for each run and member that has hydrometeors, at least one. A
// field without a member belongs to all members, unless there are hydrometeors without a member.
// Errors name `path`, the field and its level: INVALID_ARGUMENT if the files have no hydrometeors,
// are on a grid that is not read, or have levels whose heights cannot be known; DATA_LOSS if a
// level is missing.
absl::StatusOr<std::vector<GribContents>> FindGribStorms(const std::string& path,
                                                         const GribIndexes& files);

}  // namespace thunderhead::storm_files
