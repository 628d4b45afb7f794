#include "storm_files/cf_models.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace thunderhead::storm_files {
namespace {

// The names of variables or dimensions by which a model's files are known. Unused ones are empty.
struct Signs {
  std::array<std::string_view, 3> names;
  const char* advice;
};

constexpr std::array kSigns = {
    Signs{{"thl", "xt", "zt"},
          "DALES field dumps do not have the air's density; merge the base state rhobf (kg m-3) of "
          "profiles.NNN.nc at one time into the file, on zt"},
    Signs{{"l", "xt", "zt"},
          "UCLA-LES writes the liquid water potential temperature as t; keep the base state's "
          "density dn0 (kg m-3, on zt) of its analysis files in the file"},
    Signs{{"zu_3d", "x", "y"},
          "PALM's p is the deviation from its base state; add the air's density from the profile "
          "file as rho (kg m-3) on zu_3d"},
    Signs{{"q_vapour", "zn", ""},
          "MONC's p and th are deviations from its base state; add the base state's density rhon "
          "(kg m-3) on zn, of MONC's diagnostics, to the file"},
};

// Returns whether the file has all names as variables or dimensions.
bool Shows(const netcdf::NetcdfFile& file, const Signs& signs) {
  return std::ranges::all_of(signs.names, [&](std::string_view each) {
    const std::string name(each);
    return name.empty() || file.HasVariable(name) || file.DimensionLength(name).has_value();
  });
}

}  // namespace

std::string AdviceOnAir(const netcdf::NetcdfFile& file) {
  const auto found =
      std::ranges::find_if(kSigns, [&](const Signs& signs) { return Shows(file, signs); });
  return found == kSigns.end() ? "" : found->advice;
}

std::string AdviceOnUnits(const netcdf::NetcdfFile& file) {
  if (file.TextOrEmpty("time", "units") != "seconds since start") return "";
  return "MicroHH's 3d_to_nc.py writes no units: give the variable units of 'kg kg-1', and merge "
         "the other hydrometeors and the base state rhoref (kg m-3, on z) into the file";
}

}  // namespace thunderhead::storm_files
