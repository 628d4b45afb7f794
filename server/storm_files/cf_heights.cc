#include "storm_files/cf_heights.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cell_methods.h"
#include "storm_files/cf_formula.h"
#include "storm_files/cf_height_array.h"
#include "storm_files/cf_isobaric.h"
#include "storm_files/cf_origin.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

std::string NameOfPath(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// Returns why a vertical coordinate is not a height, or nothing if it is one.
std::optional<std::string> WhyNoHeight(const netcdf::NetcdfFile& file, const std::string& name) {
  const CfDescription described = DescribeCf(file, name);
  const std::string& standard = described.standard_name;
  if (absl::StrContains(standard, "sigma") || absl::StrContains(standard, "atmosphere_")) {
    return absl::StrCat("holds values of ", standard, " without usable formula_terms");
  }
  if (ConversionOf(described.units, "Pa").has_value()) return "holds pressures, not heights";
  if (ConversionOf(described.units, "K").has_value()) return "holds temperatures, not heights";
  const bool length = !HasNoUnits(described.units) && MetresIn(described.units).has_value();
  if (length) return std::nullopt;
  const std::string lower = absl::AsciiStrToLower(name);
  const std::string long_name = absl::AsciiStrToLower(file.TextOrEmpty(name, "long_name"));
  const bool plain_height =
      HasNoUnits(described.units) && standard.empty() &&
      OneOf(lower, {"z", "zh", "zc", "zt", "zm", "zu_3d", "altitude", "alt"}) &&
      !absl::StrContains(long_name, "level") && !absl::StrContains(long_name, "eta") &&
      !absl::StrContains(long_name, "index");
  if (plain_height) return std::nullopt;
  if (CountsLevels(described)) {
    return absl::StrCat("has ",
                        HasNoUnits(described.units) ? std::string("no units")
                                                    : absl::StrCat("units '", described.units, "'"),
                        ", so it holds numbers of levels (or eta), not heights");
  }
  return std::nullopt;  // another unit, which ReadHeightAxis reports
}

// Returns where models write the heights of levels that are only numbered, or of pressures. It is a
// text in parentheses, or empty.
std::string WhereHeightsAre(const netcdf::NetcdfFile& file, const std::string& name) {
  const CfDescription described = DescribeCf(file, name);
  const std::string& standard = described.standard_name;
  if (ConversionOf(described.units, "Pa").has_value()) {
    return " (pressure levels need the geopotential height of each level, such as zg in m, or the "
           "temperature with the height and the pressure of the ground: surface_altitude and "
           "surface_air_pressure)";
  }
  if (!CountsLevels(described) || absl::StrContains(standard, "sigma") ||
      absl::StrContains(standard, "atmosphere_")) {
    return "";
  }
  const char* const hhl =
      "COSMO and ICON write them to HHL or z_ifc, often in a separate file: merge it";
  if (absl::StrContains(standard, "model_level")) {
    return absl::StrCat(" (the Unified Model writes level_height, sigma and surface_altitude; ",
                        hhl, ")");
  }
  const std::string lower = absl::AsciiStrToLower(name);
  const bool numbers = absl::StrContains(lower, "height") || absl::StrContains(lower, "lev") ||
                       absl::StrContains(lower, "generalv");
  return numbers ? absl::StrCat(" (", hhl, ")") : "";
}

// Adds the height of the origin (origin_z), from which PALM's heights count, unless the coordinate
// says that it is above sea level.
void AddOriginHeight(const netcdf::NetcdfFile& file, const CfDescription& coordinate,
                     CfHeights& heights, std::vector<std::string>& assumptions) {
  const std::optional<double> origin_m = ReadCfOriginHeight_m(file);
  if (!origin_m.has_value() || *origin_m == 0.0) return;
  const std::string& standard = coordinate.standard_name;
  const bool above_origin =
      absl::StrContains(absl::AsciiStrToLower(coordinate.long_name), "above origin");
  if (!above_origin && !standard.empty() && standard != "height") {
    assumptions.push_back(
        absl::StrFormat("origin_z (%g m) is not added to the heights %s, whose "
                        "standard name says that they are above sea level.",
                        *origin_m, coordinate.name));
    return;
  }
  for (double& face_m : heights.faces_m) face_m += *origin_m;
  heights.ground_m = *origin_m;
  assumptions.push_back(absl::StrFormat(
      "The heights %s count from the origin, which is %g m above sea level (origin_z).",
      coordinate.name, *origin_m));
}

// Reads an axis of heights above sea level or above the surface.
absl::StatusOr<CfHeights> ReadHeightsOfAxis(const netcdf::NetcdfFile& file,
                                            const CfDimension& dimension,
                                            const std::optional<CfColumnValue>& terrain,
                                            std::vector<std::string>& assumptions) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfAxis axis, ReadHeightAxis(file, dimension));
  CfHeights heights;
  heights.name = dimension.coordinate;
  heights.reversed = axis.reversed;
  heights.faces_m = std::move(axis.faces);
  const CfDescription described = DescribeCf(file, dimension.coordinate);
  if (HasNoUnits(described.units)) {
    assumptions.push_back(absl::StrCat(described.name, " has no units; it is taken to be in m."));
  }
  const bool above_ground = IsAboveGround(file, dimension.coordinate, described);
  if (above_ground && terrain.has_value()) {
    heights.kind = CfHeightKind::kAboveGround;
    assumptions.push_back(absl::StrCat("The heights ", described.name,
                                       " are above the surface, by their name; the terrain ",
                                       terrain->variable.name, " is added."));
    return heights;
  }
  AddOriginHeight(file, described, heights, assumptions);
  if (heights.ground_m.has_value()) return heights;
  if (above_ground) {
    assumptions.push_back(absl::StrCat("The heights ", described.name,
                                       " are above the surface, which is taken to be at sea level "
                                       "because the file has no terrain (surface_altitude)."));
  } else if (terrain.has_value() && described.standard_name.empty()) {
    assumptions.push_back(absl::StrCat("The heights ", described.name,
                                       " are taken to be above sea level, because their name does "
                                       "not say otherwise."));
  }
  return heights;
}

}  // namespace

absl::StatusOr<CfHeights> ReadCfHeights(const netcdf::NetcdfFile& file,
                                        const netcdf::NetcdfFile* heights_file,
                                        const CfDimensions& dimensions,
                                        const std::optional<CfColumnValue>& terrain,
                                        std::vector<std::string>& assumptions) {
  THUNDERHEAD_ASSIGN_OR_RETURN(CfHeightArray array, FindHeightArray(file, dimensions, file));
  if (!array.heights.has_value() && heights_file != nullptr) {
    THUNDERHEAD_ASSIGN_OR_RETURN(array, FindHeightArray(*heights_file, dimensions, file));
  }
  if (array.heights.has_value()) {
    if (array.heights->kind == CfHeightKind::kMiddles && dimensions.axes[2].length == 1) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", array.heights->name,
          " has the height of one layer and not of its interfaces, so its thickness is not known; "
          "give at least two layers, or heights of the interfaces"));
    }
    const bool is_elsewhere = array.heights->array->of_heights_file;
    assumptions.push_back(absl::StrCat(
        "The heights of the layers are those of ", array.heights->name,
        is_elsewhere ? absl::StrCat(" in ", NameOfPath(heights_file->Path())) : "", "."));
    std::ranges::copy(array.assumptions, std::back_inserter(assumptions));
    if (array.heights->ground.has_value() && !terrain.has_value()) {
      assumptions.push_back(absl::StrCat("The ground is the lowest half level of ",
                                         array.heights->name,
                                         ", because the file has no other height of it."));
    }
    return *std::move(array.heights);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::optional<CfHeights> formula,
                               ReadFormulaHeights(file, dimensions, terrain, assumptions));
  if (formula.has_value()) return *std::move(formula);
  THUNDERHEAD_ASSIGN_OR_RETURN(formula,
                               ReadIsobaricHeights(file, dimensions, terrain, assumptions));
  if (formula.has_value()) return *std::move(formula);
  const CfDimension& z = dimensions.axes[2];
  const bool has_heights = !z.coordinate.empty() && !WhyNoHeight(file, z.coordinate).has_value();
  if (!has_heights && !array.unread.ok()) return array.unread;
  if (z.coordinate.empty()) {
    return NoCfHeights(
        file, z.name,
        z.name == "nVertLevels"
            ? "has no heights (MPAS writes them to zgrid in the init or static file: "
              "add it, for example with ncks -A -v zgrid)"
            : "has no coordinate variable, so the heights are not known");
  }
  if (const auto why = WhyNoHeight(file, z.coordinate); why.has_value()) {
    return NoCfHeights(file, z.coordinate, absl::StrCat(*why, WhereHeightsAre(file, z.coordinate)));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(formula, ReadCm1Heights(file, dimensions, terrain, assumptions));
  if (formula.has_value()) return *std::move(formula);
  return ReadHeightsOfAxis(file, z, terrain, assumptions);
}

std::optional<CfColumnValue> FindTerrain(const netcdf::NetcdfFile& file,
                                         const CfDimensions& dimensions,
                                         std::vector<std::string>& assumptions) {
  std::string unread;
  for (const bool by_name : {false, true}) {
    for (const std::string& name : file.Variables()) {
      const CfDescription described = DescribeCf(file, name);
      const bool altitude = described.standard_name == "surface_altitude";
      const bool geopotential = described.standard_name == "surface_geopotential";
      const bool model = described.standard_name.empty() &&
                         OneOf(name, {"zs", "ZS", "hsurf", "HSURF", "HGT", "hgt", "orog", "topo",
                                      "FIS", "PHIS", "topography_c", "zsurf"});
      if (by_name ? !model : !altitude && !geopotential) continue;
      if (HoldsNoAmount(file, name)) continue;
      const auto variable = Arrange(file, name, dimensions);
      const bool fits = variable.ok() && variable->places[0] >= 0 && variable->places[1] >= 0 &&
                        variable->places[2] < 0 && variable->more == std::array<int, 3>{0, 0, 0};
      const auto scale = HeightScale(described.units);
      if (fits && scale.has_value()) return CfColumnValue{*variable, *scale};
      const bool looks_like_terrain = variable.ok() && variable->places[2] < 0;
      if (!altitude && !looks_like_terrain) continue;
      unread = name;
      spdlog::warn("{}: {} (units '{}') is not read; it must be on the fields' x and y, in m or km",
                   file.Path(), name, described.units);
    }
  }
  if (!unread.empty()) {
    assumptions.push_back(absl::StrCat("The ground is at sea level, because the terrain ", unread,
                                       " is not on the fields' x and y in a unit of length."));
  }
  return std::nullopt;
}

}  // namespace thunderhead::storm_files
