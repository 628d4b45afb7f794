#include "storm_files/wrf_land.h"

#include <initializer_list>
#include <optional>

#include "absl/strings/match.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_files {
namespace {

constexpr WrfUnit kShare = {"1"};
constexpr WrfUnit kPercent = {"%"};

// Returns the land-use scheme by the name of its table of classes, or else by the number of
// classes.
std::optional<physics::LandUseScheme> LandUseSchemeOf(const netcdf::NetcdfFile& file) {
  const std::string name = file.TextAttribute("", "MMINLU").value_or("");
  if (absl::StrContains(name, "MODI")) return physics::LandUseScheme::kModis;
  if (absl::StrContains(name, "USGS")) return physics::LandUseScheme::kUsgs;
  const double classes = file.NumberAttribute("", "NUM_LAND_CAT").value_or(0.0);
  if (classes == 20.0 || classes == 21.0) return physics::LandUseScheme::kModis;
  if (classes == 24.0) return physics::LandUseScheme::kUsgs;
  return std::nullopt;
}

}  // namespace

WrfLand FindLand(const netcdf::NetcdfFile& file, const WrfLayout& layout) {
  WrfLand land;
  const auto find = [&](std::initializer_list<const char*> names,
                        const std::optional<WrfUnit>& unit) -> std::string {
    for (const char* name : names) {
      if (!file.HasVariable(name)) continue;
      const absl::Status units =
          unit.has_value() ? CheckUnits(file, name, *unit) : absl::OkStatus();
      if (!units.ok()) {
        spdlog::warn("the ground is drawn without {}: {}", name, std::string(units.message()));
        continue;
      }
      if (HasShape(file, layout, name, layout.Columns(), Changes::kNever)) return name;
      spdlog::warn("{}: {} has not one value a column and is not read", file.Path(), name);
    }
    return "";
  };
  const std::optional<physics::LandUseScheme> scheme = LandUseSchemeOf(file);
  if (!scheme.has_value()) {
    if (file.HasVariable("LU_INDEX")) {
      spdlog::warn(
          "{}: the ground is drawn plain, as LU_INDEX counts classes of an unknown table; MMINLU "
          "is to name USGS or MODIS",
          file.Path());
    }
    return land;
  }
  land.scheme = *scheme;
  land.land_use = find({"LU_INDEX"}, std::nullopt);
  if (land.land_use.empty()) return land;
  land.mask = find({"XLAND", "LANDMASK"}, std::nullopt);
  land.albedo = find({"ALBEDO"}, kShare);
  land.green = find({"VEGFRA"}, kPercent);
  land.snow_share = find({"SNOWC"}, kShare);
  if (land.snow_share.empty()) land.snow_depth = find({"SNOWH"}, kWrfLength);
  return land;
}

}  // namespace thunderhead::storm_files
