#include "storm_files/cf_isobaric.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "storm_files/cf_terms.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// Returns the pressure of the ground, or nothing if the file has none on x and y.
std::optional<CfColumnValue> FindSurfacePressure(const netcdf::NetcdfFile& file,
                                                 const CfDimensions& dimensions) {
  const std::string name = CfSurfacePressure(file);
  if (name.empty()) return std::nullopt;
  const auto variable = Arrange(file, name, dimensions);
  const auto conversion = ConversionOf(file.TextOrEmpty(name, "units"), "Pa");
  if (!variable.ok() || !conversion.has_value() || conversion->offset != 0.0 ||
      variable->places[0] < 0 || variable->places[1] < 0 || variable->places[2] >= 0 ||
      variable->more != std::array<int, 3>{0, 0, 0}) {
    return std::nullopt;
  }
  return CfColumnValue{*variable, conversion->scale};
}

}  // namespace

bool HoldsAirPressure(const netcdf::NetcdfFile& file, const std::string& coordinate) {
  const CfDescription levels = DescribeCf(file, coordinate);
  if (!ConversionOf(levels.units, "Pa").has_value()) return false;
  if (!levels.standard_name.empty() && levels.standard_name != "air_pressure") return false;
  const std::string long_name = absl::AsciiStrToLower(levels.long_name);
  for (const char* nominal : {"hybrid", "sigma", "eta", "nominal", "reference", "midpoint"}) {
    if (absl::StrContains(long_name, nominal)) return false;
  }
  return file.TextOrEmpty(coordinate, "formula_terms").empty();
}

absl::StatusOr<std::optional<CfHeights>> ReadIsobaricHeights(
    const netcdf::NetcdfFile& file, const CfDimensions& dimensions,
    const std::optional<CfColumnValue>& terrain, std::vector<std::string>& assumptions) {
  const CfDimension& z = dimensions.axes[2];
  if (z.coordinate.empty() || z.length < 2 || !terrain.has_value() ||
      !HoldsAirPressure(file, z.coordinate)) {
    return std::optional<CfHeights>();
  }
  CfHeights heights;
  heights.surface_pressure = FindSurfacePressure(file, dimensions);
  if (!heights.surface_pressure.has_value()) return std::optional<CfHeights>();
  heights.kind = CfHeightKind::kIsobaric;
  heights.name = z.coordinate;
  THUNDERHEAD_ASSIGN_OR_RETURN(heights.a_middle, file.ReadDoubles(z.coordinate));
  const auto conversion = ConversionOf(file.TextOrEmpty(z.coordinate, "units"), "Pa");
  for (double& each_Pa : heights.a_middle) each_Pa = (*conversion)(each_Pa);
  heights.reversed = heights.a_middle.front() < heights.a_middle.back();
  if (heights.reversed) std::ranges::reverse(heights.a_middle);
  const bool falls =
      std::ranges::adjacent_find(heights.a_middle, std::less_equal<>()) == heights.a_middle.end();
  if (heights.a_middle.size() != z.length || !falls || !(heights.a_middle.back() > 0.0)) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": the pressures ", z.coordinate,
        " neither rise nor fall all along, or are not above 0; write the levels in order"));
  }
  assumptions.push_back(absl::StrCat(
      "The heights of the levels ", z.coordinate,
      " follow from temperature and humidity by the hydrostatic equation, from the ground ",
      terrain->variable.name, " at the pressure ", heights.surface_pressure->variable.name,
      ". Levels below the ground are left out."));
  return std::optional(std::move(heights));
}

}  // namespace thunderhead::storm_files
