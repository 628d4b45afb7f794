#include "storm_files/cf_heights.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cell_methods.h"
#include "storm_files/cf_formula.h"
#include "storm_files/cf_origin.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

bool OneOf(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

// The gravity by which geopotential is divided to get geopotential height.
constexpr double kGeopotentialGravity_m_per_s2 = 9.80665;

// Returns the metres in a unit of height or of geopotential.
std::optional<double> HeightScale(const std::string& units) {
  if (HasNoUnits(units)) return std::nullopt;
  if (const auto metres = MetresIn(units); metres.has_value()) return metres;
  const auto geopotential = ConversionOf(units, "m2 s-2");
  if (!geopotential.has_value()) return std::nullopt;
  return geopotential->scale / kGeopotentialGravity_m_per_s2;
}

// Returns whether a variable holds heights of layers, by its standard name or by the name that a
// model gives it.
bool HoldsHeights(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  if (!standard.empty()) {
    return OneOf(standard,
                 {"altitude", "height", "height_above_mean_sea_level",
                  "height_above_reference_ellipsoid", "geopotential_height", "geopotential",
                  "height_above_geopotential_datum", "geometric_height_at_half_level_center",
                  "geometric_height_at_full_level_center", "geometric_height_at_cell_center"});
  }
  const std::string name = absl::AsciiStrToLower(variable.name);
  return OneOf(
      name, {"hhl", "hfl", "z_ifc", "z_mc", "zhval", "zghalf", "zgfull", "zg", "zgeo", "altitude",
             "alt", "height", "geopotential_height", "geopotential", "zgrid", "zh"});
}

bool IsAboveGround(const netcdf::NetcdfFile& file, const std::string& variable,
                   const CfDescription& described) {
  if (described.standard_name == "height") return true;
  const std::string name = absl::AsciiStrToLower(file.TextOrEmpty(variable, "long_name"));
  return absl::StrContains(name, "above ground") || absl::StrContains(name, "above surface") ||
         absl::StrContains(name, "above the surface") || absl::StrContains(name, "agl");
}

// Returns an array of heights on the fields' columns, if the file has one.
std::optional<CfHeights> FindHeightArray(const netcdf::NetcdfFile& file,
                                         const CfDimensions& dimensions) {
  std::optional<CfHeights> found;
  for (const std::string& name : file.Variables()) {
    const CfDescription described = DescribeCf(file, name);
    if (!HoldsHeights(described) || HoldsNoAmount(file, name)) continue;
    const auto array = Arrange(file, name, dimensions);
    if (!array.ok() || array->places[0] < 0 || array->places[1] < 0 || array->places[2] < 0 ||
        array->more[0] != 0 || array->more[1] != 0) {
      continue;
    }
    const auto scale = HeightScale(described.units);
    if (!scale.has_value()) continue;
    // Faces are better than middles.
    if (found.has_value() && (found->kind == CfHeightKind::kFaces || array->more[2] == 0)) continue;
    found.emplace();
    found->kind = array->more[2] == 1 ? CfHeightKind::kFaces : CfHeightKind::kMiddles;
    found->name = name;
    found->array = *array;
    found->scale = *scale;
    found->above_ground = IsAboveGround(file, name, described);
  }
  return found;
}

// Finds out whether the layers of an array run downwards, from one column of the first record.
absl::Status OrientArray(const netcdf::NetcdfFile& file, CfHeights& heights) {
  const CfVariable& array = *heights.array;
  const auto rank = static_cast<std::size_t>(array.dimensions);
  const auto z = static_cast<std::size_t>(array.places[2]);
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(array.name));
  const std::vector<std::size_t> start(rank, 0);
  std::vector<std::size_t> count(rank, 1);
  count[z] = shape[z];
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> column,
                               file.ReadPart(array.name, start, count));
  heights.reversed = column.front() > column.back();
  return absl::OkStatus();
}

// Returns what a vertical coordinate counts that is not metres, or nothing if it is a height.
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
      !absl::StrContains(long_name, "level") && !absl::StrContains(long_name, "eta");
  if (plain_height) return std::nullopt;
  if (HasNoUnits(described.units) || ConversionOf(described.units, "1").has_value() ||
      OneOf(absl::AsciiStrToLower(described.units), {"level", "levels", "layer", "sigma_level"})) {
    return absl::StrCat("has ",
                        HasNoUnits(described.units) ? std::string("no units")
                                                    : absl::StrCat("units '", described.units, "'"),
                        ", so it holds numbers of levels (or eta), not heights");
  }
  return std::nullopt;  // another unit, which ReadHeightAxis reports
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
                                        const CfDimensions& dimensions,
                                        const std::optional<CfColumnValue>& terrain,
                                        std::vector<std::string>& assumptions) {
  if (std::optional<CfHeights> array = FindHeightArray(file, dimensions); array.has_value()) {
    if (array->kind == CfHeightKind::kMiddles && dimensions.axes[2].length == 1) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", array->name,
          " has the height of one layer and not of its interfaces, so its thickness is not known; "
          "give at least two layers, or heights of the interfaces"));
    }
    THUNDERHEAD_RETURN_IF_ERROR(OrientArray(file, *array));
    assumptions.push_back(
        absl::StrCat("The heights of the layers are those of ", array->name, "."));
    return *std::move(array);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::optional<CfHeights> formula,
                               ReadFormulaHeights(file, dimensions, terrain, assumptions));
  if (formula.has_value()) return *std::move(formula);
  const CfDimension& z = dimensions.axes[2];
  if (z.coordinate.empty()) {
    return NoCfHeights(
        file, z.name,
        z.name == "nVertLevels"
            ? "has no heights (MPAS writes them to zgrid in the init or static file: "
              "add it, for example with ncks -A -v zgrid)"
            : "has no coordinate variable, so the heights are not known");
  }
  // COSMO and ICON number their levels and keep the heights in HHL, often in another file.
  if (const auto why = WhyNoHeight(file, z.coordinate); why.has_value()) {
    const std::string lower = absl::AsciiStrToLower(z.coordinate);
    const bool numbers = absl::StrContains(lower, "height") || absl::StrContains(lower, "lev") ||
                         absl::StrContains(lower, "generalv");
    return NoCfHeights(file, z.coordinate,
                       numbers ? absl::StrCat(*why,
                                              " (COSMO and ICON write them to HHL or z_ifc, "
                                              "often in a separate file: merge it)")
                               : *why);
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
