#include "storm_files/cf_models.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "storm_files/cf_cells.h"
#include "storm_files/cf_checks.h"

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

bool IsRatio(const CfField& field) {
  return field.quantity.quantity == volume::Quantity::kMixingRatio;
}

bool IsIcon(const netcdf::NetcdfFile& file) {
  return file.TextAttribute("", "uuidOfHGrid").has_value() ||
         file.NumberAttribute("", "number_of_grid_used").has_value();
}

// ICON's mixing ratios are per kg of the whole air: dry air, vapour and condensate together.
void ApplyIcon(CfMetadata& metadata) {
  if (std::ranges::none_of(metadata.fields, IsRatio)) return;
  for (CfField& field : metadata.fields) field.quantity.of_moist_air = true;
  for (CfAirField& field : metadata.air) {
    if (field.air.variable == AirVariable::kVapour) field.air.of_moist_air = true;
  }
  metadata.assumptions.push_back(
      "Masses per kg are those per kg of the whole air, as in all files of ICON.");
}

void ApplyMpas(const netcdf::NetcdfFile& file, CfMetadata& metadata) {
  if (!IsMpas(file) || !Has(metadata, AirVariable::kDensity)) return;
  // MPAS writes the density of dry air. Without a humidity, this program takes the density as that
  // of dry air, so the humidity is left out.
  std::erase_if(metadata.air,
                [](const CfAirField& field) { return field.air.variable == AirVariable::kVapour; });
  metadata.assumptions.push_back("The air's density is that of dry air, as in MPAS.");
}

// CAM's mixing ratios are per kg of moist or of dry air. An attribute says which, but older
// versions do not write it.
void ApplyCam(const netcdf::NetcdfFile& file, CfMetadata& metadata) {
  for (CfField& field : metadata.fields) {
    const std::string& name = field.variable.name;
    if (!IsCamName(name) || !IsRatio(field)) continue;
    field.quantity.of_moist_air = file.TextOrEmpty(name, "mixing_ratio") != "dry";
    metadata.assumptions.push_back(absl::StrCat(
        name, " is per kg of ", field.quantity.of_moist_air ? "moist" : "dry", " air, as in CAM."));
  }
}

// States of which air the mixing ratios are, and what says so. CAM's are stated by ApplyCam.
void StateAirOfRatios(CfMetadata& metadata) {
  std::map<std::pair<bool, std::string>, std::vector<std::string>> names;  // by air and attribute
  for (const CfField& field : metadata.fields) {
    const std::string& name = field.variable.name;
    if (!IsRatio(field) || IsCamName(name)) continue;
    auto& same = names[{field.quantity.of_moist_air, std::string(field.quantity.of_air_by)}];
    if (std::ranges::find(same, name) == same.end()) same.push_back(name);
  }
  for (const auto& [air, same] : names) {
    const auto& [moist, by] = air;
    const bool one = same.size() == 1;
    metadata.assumptions.push_back(absl::StrCat(
        absl::StrJoin(same, ", "),
        by.empty() ? (one ? " is taken to be" : " are taken to be") : (one ? " is" : " are"),
        " per kg of ", moist ? "the whole air (dry air, vapour and condensate)" : "dry air", ", ",
        by.empty() ? "because the file does not say which air is meant"
                   : absl::StrCat("by the ", by),
        "."));
  }
}

// States that the air is taken as dry, if the file has no humidity. MPAS writes the density of dry
// air, which needs none.
void StateDryAir(const netcdf::NetcdfFile& file, CfMetadata& metadata) {
  const bool needs_air =
      std::ranges::any_of(metadata.fields, IsRatio) || FollowFromAir(metadata.heights.kind);
  if (!needs_air || Has(metadata, AirVariable::kVapour)) return;
  const auto density =
      std::ranges::find(metadata.air, AirVariable::kDensity,
                        [](const CfAirField& field) { return field.air.variable; });
  if (density == metadata.air.end()) {
    metadata.assumptions.push_back("The air is taken as dry, because the file has no humidity.");
  } else if (!IsMpas(file)) {
    metadata.assumptions.push_back(absl::StrCat("The density ", density->variable.name,
                                                " is taken as that of dry air, because the file "
                                                "has no humidity."));
  }
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

void ApplyModel(const netcdf::NetcdfFile& file, CfMetadata& metadata) {
  if (IsIcon(file)) {
    ApplyIcon(metadata);
  } else {
    StateAirOfRatios(metadata);
  }
  ApplyMpas(file, metadata);
  ApplyCam(file, metadata);
  StateDryAir(file, metadata);
}

}  // namespace thunderhead::storm_files
