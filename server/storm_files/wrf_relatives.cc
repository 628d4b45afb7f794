#include "storm_files/wrf_relatives.h"

#include <algorithm>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr char kGiveHistory[] = "give the model's own file (wrfout_...) with PH and PHB";

// Returns the dimension of levels of the first hydrometeor with WRF's name, or an empty text.
std::string LevelsOf(const netcdf::NetcdfFile& file) {
  constexpr std::size_t kRank = 3;
  for (const char* name : {"QCLOUD", "QRAIN", "QICE", "QSNOW", "QGRAUP", "QHAIL"}) {
    const auto dimensions = file.Dimensions(name);
    if (dimensions.ok() && dimensions->size() >= kRank) return dimensions->end()[-3];
  }
  return "";
}

bool HasHeights(const netcdf::NetcdfFile& file) {
  return file.HasVariable("PHB") && (file.HasVariable("PH") || file.HasVariable("PH_2"));
}

std::optional<std::string> WhyInput(const netcdf::NetcdfFile& file) {
  const std::string title = file.TextOrEmpty("", "TITLE");
  for (const char* program : {"GEOGRID", "METGRID"}) {
    if (absl::StrContains(title, program)) {
      return absl::StrCat("is output of ", program,
                          ", which prepares the model's input; give the model's output "
                          "(wrfout_...)");
    }
  }
  if (file.DimensionLength("bdy_width").has_value()) {
    return "holds the model's boundary values (wrfbdy); give the model's output (wrfout_...)";
  }
  return std::nullopt;
}

std::optional<std::string> WhyPressureLevels(const netcdf::NetcdfFile& file) {
  for (const char* name : {"GHT_PL", "T_PL", "RH_PL", "U_PL"}) {
    if (!file.HasVariable(name)) continue;
    return absl::StrCat("holds WRF's output on pressure levels (", name,
                        " and the like), without hydrometeors; give the model's own file "
                        "(wrfout_...) with QCLOUD and the like");
  }
  const std::string levels = LevelsOf(file);
  if (levels.empty() || !file.HasVariable(levels) || HasHeights(file)) return std::nullopt;
  const std::string units = file.TextOrEmpty(levels, "units");
  const bool pressure = ConversionOf(units, "Pa").has_value() ||
                        file.TextOrEmpty(levels, "standard_name") == "air_pressure";
  const bool with_heights = std::ranges::any_of(
      std::vector<std::string>{"height", "z", "geopotential_height"},
      [&](const std::string& name) { return name != levels && file.HasVariable(name); });
  if (!pressure || with_heights) return std::nullopt;
  return absl::StrCat("has pressure levels (", levels, " in ", units,
                      ") without their heights, which are needed; add the heights as a variable ",
                      "height (m), or ", kGiveHistory);
}

}  // namespace

bool HasWrfTitle(const netcdf::NetcdfFile& file) {
  const std::string title = file.TextOrEmpty("", "TITLE");
  return absl::StrContains(title, "OUTPUT FROM") &&
         (absl::StrContains(title, "WRF") || absl::StrContains(title, "REAL_EM") ||
          absl::StrContains(title, "IDEAL") || absl::StrContains(title, "GEOGRID") ||
          absl::StrContains(title, "METGRID"));
}

bool IsOnEta(const netcdf::NetcdfFile& file) {
  const std::string levels = LevelsOf(file);
  if (levels.empty() || !file.HasVariable(levels) || HasHeights(file)) return false;
  // With formula_terms, the heights of eta levels follow by CF's formulas.
  if (!file.TextOrEmpty(levels, "formula_terms").empty()) return false;
  const std::string name = file.TextOrEmpty(levels, "standard_name");
  const std::string about = absl::StrCat(file.TextOrEmpty(levels, "description"), " ",
                                         file.TextOrEmpty(levels, "long_name"));
  return absl::StrContains(name, "sigma") || absl::StrContains(about, "eta values");
}

std::optional<std::string> WhyOnlyRelated(const netcdf::NetcdfFile& file) {
  if (auto why = WhyInput(file)) return why;
  if (IsOnEta(file)) {
    return absl::StrCat(
        "its vertical coordinate ", LevelsOf(file),
        " counts eta, as in output of xwrf, and not metres; heights are needed: ", kGiveHistory);
  }
  return WhyPressureLevels(file);
}

std::optional<std::string> WhyOnlyTile(const netcdf::NetcdfFile& file) {
  struct Axis {
    const char* dimension;
    const char* prefix;
  };
  for (const Axis& axis : {Axis{"west_east", "WEST-EAST"}, Axis{"south_north", "SOUTH-NORTH"}}) {
    const auto number = [&](const char* name) {
      return file.NumberAttribute("", absl::StrCat(axis.prefix, name));
    };
    const auto first = number("_PATCH_START_UNSTAG");
    const auto last = number("_PATCH_END_UNSTAG");
    const auto corners = number("_GRID_DIMENSION");
    const auto length = file.DimensionLength(axis.dimension);
    if (!first || !last || !corners || !length) continue;
    const double cells = *last - *first + 1.0;
    // A part that was cut out later keeps the attributes, but has another length.
    if (cells < *corners - 1.0 && cells == static_cast<double>(*length)) {
      return absl::StrCat("is one process's tile of the domain (", axis.dimension, " ", *first,
                          " to ", *last, " of ", *corners - 1.0,
                          "); join the tiles (JOINER of WRF), or run WRF with io_form_history = 2");
    }
  }
  return std::nullopt;
}

}  // namespace thunderhead::storm_files
