// Writes small files with known contents in WRF's output layout. A file is valid, or broken in one
// chosen way. This code calls netCDF-C without a lock, so a test must write its files before
// another thread reads.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace thunderhead::testing {

// The end of a PROJ string for WRF's map projections, which assume a spherical Earth.
inline constexpr char kSphereOfWrf[] = " +x_0=0 +y_0=0 +R=6370000 +units=m +no_defs";

// A cell of the file. The indices count from the west, the south and the bottom; `record` is the
// index of the time.
struct WrfCell {
  int x = 0;
  int y = 0;
  int level = 0;
  int record = 0;
};

// A value that is stored in the file instead of the computed value.
struct StoredValue {
  std::string variable;
  WrfCell cell;
  double value = 0.0;
};

enum class WrfFormat { kNetcdf4, kClassic, kOffset64, kCdf5 };

// The contents of a file. The layers follow the terrain at the bottom and are level at the top. All
// layers of a column are equally thick, unless `interface_height_m` says otherwise.
struct SyntheticWrf {
  int nx = 4;
  int ny = 3;
  int levels = 8;
  double dx_m = 1000.0;
  double dy_m = 2000.0;
  double top_m = 4000.0;
  std::vector<std::string> times = {"2013-05-20_20:00:00"};
  std::function<double(int x, int y)> terrain_m;  // height of the terrain; empty: 0 m everywhere
  // Height of an interface between two layers; `level` counts interfaces from the bottom.
  std::function<double(const WrfCell&)> interface_height_m;

  double pressure_Pa = 80'000.0;
  double potential_temperature_K = 310.0;
  // Potential temperature of each cell (K). Empty: potential_temperature_K everywhere.
  std::function<double(const WrfCell&)> potential_temperature_at_K;
  double vapour_kg_per_kg = 0.01;

  // Mixing ratios by variable name. Other mixing ratios are not in the file.
  std::map<std::string, std::function<double(const WrfCell&)>> mixing_ratios;

  // Two-dimensional fields in addition to HGT, by variable name. An example is LU_INDEX. XLAT and
  // XLONG replace the places that follow from `latitude_deg` and `longitude_deg`.
  std::map<std::string, std::function<double(const WrfCell&)>> columns;
  std::string land_use_table;  // attribute MMINLU; empty: the file does not have it
  int land_use_classes = 0;    // attribute NUM_LAND_CAT; 0: the file does not have it

  double latitude_deg = 35.0;    // latitude and longitude of the south-west cell. They increase by
  double longitude_deg = -97.0;  // equal steps, whose lengths at the middle are dx_m and dy_m.
  int map_projection = 1;
  std::map<std::string, double> numbers;  // additional global attributes, such as TRUELAT1
  int domain = 1;
  int microphysics = 0;  // attribute MP_PHYSICS; 0: the file does not have it
  int hail_option = 0;   // attribute HAIL_OPT; 0: the file does not have it
  std::string simulation_start = "2013-05-20_12:00:00";

  WrfFormat format = WrfFormat::kNetcdf4;
  std::set<std::string> omitted;    // variables and global attributes that the file does not have
  std::set<std::string> unwritten;  // variables that are declared but never written
  std::set<std::string> packed;     // variables stored as shorts with scale_factor and add_offset
  std::set<std::string> one_level_short;  // variables that have one level fewer than they should
  // By variable name: a units attribute that replaces the correct one.
  std::map<std::string, std::string> units;
  std::map<std::string, double> fill_values;  // by variable name: the attribute _FillValue
  std::vector<StoredValue> stored_values;
  std::vector<double> minutes;  // variable XTIME (minutes since the start of the run); empty: the
                                // file does not have it
  // The file as programs that process WRF output leave it.
  std::set<std::string> without_time;                     // variables without the dimension Time
  std::set<std::string> at_one_time;                      // variables on their own time dimension
  std::map<std::string, std::string> renamed_dimensions;  // new names by WRF's names
  std::map<std::string, std::string> renamed;             // new names of variables by WRF's names
  // Text attributes by variable and attribute. The global attributes have the variable "".
  std::map<std::string, std::map<std::string, std::string>> texts;
  // Values of a coordinate variable of the levels. It has the name of their dimension.
  std::vector<double> level_coordinate;
  double north_per_record_deg = 0.0;  // how far a moving nest moves between two records
  double east_per_record_deg = 0.0;
  int times_left_blank = 0;  // number of records at the end whose Times are not written yet
};

// Returns the height of an interface between two layers of `file`; `cell.level` counts interfaces.
double InterfaceHeight_m(const SyntheticWrf& file, const WrfCell& cell);

// Writes `file` to `path`. Aborts the test program if writing fails.
void WriteWrf(const SyntheticWrf& file, const std::string& path);

}  // namespace thunderhead::testing
