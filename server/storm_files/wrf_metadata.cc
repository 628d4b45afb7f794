#include "storm_files/wrf_metadata.h"
#include "storm_files/cell_methods.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "spdlog/spdlog.h"
#include "storm_files/true_scale.h"
#include "storm_files/wrf_relatives.h"
#include "storm_files/wrf_times.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

constexpr std::array<std::string_view, physics::kHydrometeorCount> kHydrometeorVariables = {
    "QCLOUD", "QRAIN", "QICE", "QSNOW", "QGRAUP", "QHAIL"};

constexpr WrfUnit kMixingRatio = {"kg kg-1"};
constexpr WrfUnit kPressure = {"Pa"};
constexpr WrfUnit kHectopascal = {"hPa"};
constexpr WrfUnit kCelsius = {"degC"};
constexpr WrfUnit kGeopotential = {"m2 s-2"};
constexpr WrfUnit kEnergy = kGeopotential;
constexpr WrfUnit kVelocity = {"m s-1"};
constexpr WrfUnit kTemperature = {"K"};
constexpr WrfUnit kKilometre = {"km"};
constexpr WrfUnit kPerMass = {"kg-1"};

// Variables of particle sizes. Radii come before numbers, because a number needs an assumed size
// distribution.
struct SizeName {
  Hydrometeor hydrometeor;
  std::string_view variable;
  bool is_count;
};
constexpr std::array kSizeNames = {
    SizeName{Hydrometeor::kCloud, "RE_CLOUD", false},
    SizeName{Hydrometeor::kIce, "RE_ICE", false},
    SizeName{Hydrometeor::kSnow, "RE_SNOW", false},
    SizeName{Hydrometeor::kCloud, "QNCLOUD", true},
    SizeName{Hydrometeor::kRain, "QNRAIN", true},
    SizeName{Hydrometeor::kIce, "QNICE", true},
    SizeName{Hydrometeor::kSnow, "QNSNOW", true},
    SizeName{Hydrometeor::kGraupel, "QNGRAUPEL", true},
};

// WRF's variable T is the potential temperature minus this value.
constexpr double kBaseTheta_K = 300.0;

// Reads the distances on the model's map. They are 0 if the file does not have them.
void ReadSpacing(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const std::pair<const char*, double*> spacings[] = {{"DX", &metadata.dx_m},
                                                      {"DY", &metadata.dy_m}};
  for (const auto& [name, spacing_m] : spacings) {
    const double given_m = file.NumberAttribute("", name).value_or(0.0);
    *spacing_m = given_m > 0.0 && std::isfinite(given_m) ? given_m : 0.0;
  }
}

absl::Status CheckSpacing(const netcdf::NetcdfFile& file, const WrfMetadata& metadata) {
  if (metadata.dx_m > 0.0 && metadata.dy_m > 0.0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": the global attributes DX and DY (metres, above zero) are missing or wrong, ",
      "and no latitudes and longitudes (XLAT, XLONG) give the distances; add one of them"));
}

// A variable that another program writes in place of WRF's own. Its values times `scale`, plus
// `offset`, are in SI units.
struct Alternative {
  const char* variable;
  const WrfUnit& unit;
  double scale;
  double offset;
};

// Returns whether a height is counted from the ground instead of from sea level.
bool IsAboveGround(const netcdf::NetcdfFile& file, const std::string& variable) {
  return file.TextOrEmpty(variable, "standard_name") == "height" ||
         absl::StrContains(file.TextOrEmpty(variable, "description"), "AGL");
}

// Returns the first alternative that the file has, in the unit that is named. Such a variable may
// have one value for each level.
WrfTerm FirstOf(const netcdf::NetcdfFile& file, const WrfLayout& layout,
                std::initializer_list<Alternative> alternatives) {
  const std::vector<std::size_t> levels = {static_cast<std::size_t>(layout.cells.z)};
  for (const Alternative& each : alternatives) {
    if (file.TextOrEmpty(each.variable, "units").empty() ||
        !HasUnits(file, each.variable, each.unit) || IsAboveGround(file, each.variable)) {
      continue;
    }
    const bool per_level = file.Shape(each.variable).value_or(std::vector<std::size_t>()) == levels;
    if (per_level || HasShape(file, layout, each.variable, layout.Layers(), Changes::kAtEachTime)) {
      return {each.variable, each.scale, each.offset, per_level};
    }
  }
  return {};
}

// Finds the heights: WRF's own geopotential, that of a restart file, or heights of the layers'
// middles that wrf-python has computed.
absl::Status FindHeights(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  WrfHeights& heights = metadata.heights;
  if (!file.HasVariable("PH") && !file.HasVariable("PH_2")) {
    const std::string levels = layout.levels;
    heights.middles = FirstOf(file, layout,
                              {{"height", kWrfLength, 1.0, 0.0},
                               {"height", kKilometre, 1000.0, 0.0},
                               {"z", kWrfLength, 1.0, 0.0},
                               {"z", kKilometre, 1000.0, 0.0},
                               {"geopotential_height", kWrfLength, 1.0, 0.0},
                               {levels.c_str(), kWrfLength, 1.0, 0.0},
                               {levels.c_str(), kKilometre, 1000.0, 0.0}});
    if (!heights.middles.variable.empty() && layout.cells.z == 1) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", heights.middles.variable,
          " has the height of one layer, so its thickness is not known; give at least two layers, "
          "or PH and PHB"));
    }
    if (!heights.middles.variable.empty()) {
      metadata.assumptions.push_back(absl::StrCat(
          heights.middles.variable,
          " is taken as the height of the layers' middles above sea level, because the file has no "
          "PH and PHB."));
      return absl::OkStatus();
    }
  }
  heights.perturbation = file.HasVariable("PH") || !file.HasVariable("PH_2") ? "PH" : "PH_2";
  heights.base = "PHB";
  if (const auto interfaces = file.DimensionLength("bottom_top_stag");
      interfaces.has_value() && *interfaces != layout.Interfaces().front()) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": bottom_top_stag is ", *interfaces,
        " where bottom_top + 1 = ", layout.Interfaces().front(), " is needed; extract all levels"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, layout, heights.perturbation, layout.Interfaces(),
                                            kGeopotential, Changes::kAtEachTime));
  return CheckVariable(file, layout, heights.base, layout.Interfaces(), kGeopotential,
                       Changes::kNever);
}

// Returns whether `variable` is the potential temperature of moist air. WRF has it in THM, and
// some versions in T.
bool IsMoist(const netcdf::NetcdfFile& file, const std::string& variable) {
  if (file.NumberAttribute("", "USE_THETA_M").value_or(0.0) != 1.0) return false;
  return variable != "T" || absl::StrContains(file.TextOrEmpty("T", "description"), "moist");
}

absl::Status FindTemperature(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  WrfAir& air = metadata.air;
  for (const char* name : {"T", "T_2", "THM_2", "THM"}) {
    if (!file.HasVariable(name)) continue;
    air.temperature = {name, 1.0, kBaseTheta_K, false};
    air.potential = true;
    air.moist = IsMoist(file, name);
    return CheckVariable(file, layout, name, layout.Layers(), kTemperature, Changes::kAtEachTime);
  }
  air.temperature =
      FirstOf(file, layout, {{"theta", kTemperature, 1.0, 0.0}, {"th", kTemperature, 1.0, 0.0}});
  air.potential = !air.temperature.variable.empty();
  if (air.potential) return absl::OkStatus();
  air.temperature = FirstOf(file, layout,
                            {{"temp", kTemperature, 1.0, 0.0},
                             {"temp", kCelsius, 1.0, 273.15},
                             {"tk", kTemperature, 1.0, 0.0},
                             {"tc", kCelsius, 1.0, 273.15}});
  if (!air.temperature.variable.empty()) return absl::OkStatus();
  return CheckVariable(file, layout, "T", layout.Layers(), kTemperature, Changes::kAtEachTime);
}

absl::Status FindAir(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  WrfAir& air = metadata.air;
  WrfTerm pressure;
  if (!file.HasVariable("PB")) {
    const std::string levels = layout.levels;
    pressure = FirstOf(file, layout,
                       {{"pressure", kPressure, 1.0, 0.0},
                        {"pressure", kHectopascal, 100.0, 0.0},
                        {"pres", kPressure, 1.0, 0.0},
                        {levels.c_str(), kPressure, 1.0, 0.0},
                        {levels.c_str(), kHectopascal, 100.0, 0.0}});
  }
  if (!pressure.variable.empty()) {
    air.pressure = {pressure};
  } else {
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckVariable(file, layout, "P", layout.Layers(), kPressure, Changes::kAtEachTime));
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckVariable(file, layout, "PB", layout.Layers(), kPressure, Changes::kNever));
    air.pressure = {{"P"}, {"PB"}};
  }
  THUNDERHEAD_RETURN_IF_ERROR(FindTemperature(file, metadata));
  air.has_vapour = file.HasVariable("QVAPOR");
  if (!air.has_vapour) {
    metadata.assumptions.push_back("The air is taken as dry, because the file has no QVAPOR.");
    return absl::OkStatus();
  }
  return CheckVariable(file, layout, "QVAPOR", layout.Layers(), kMixingRatio, Changes::kAtEachTime);
}

// Finds further categories of ice, as in the schemes P3 and ISHMAEL.
absl::Status FindMoreIce(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  if (metadata.variables[physics::IndexOf(Hydrometeor::kIce)].empty()) return absl::OkStatus();
  for (const char* name : {"QICE2", "QICE3"}) {
    if (!file.HasVariable(name)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, metadata.layout, name, metadata.layout.Layers(),
                                              kMixingRatio, Changes::kAtEachTime));
    metadata.more_ice.emplace_back(name);
  }
  if (!metadata.more_ice.empty()) {
    metadata.assumptions.push_back(absl::StrCat("The cloud ice is the sum of QICE and ",
                                                absl::StrJoin(metadata.more_ice, " and "), "."));
  }
  return absl::OkStatus();
}

// Adds an assumption if all water is liquid, and the file does not say which scheme wrote it. The
// variables of some schemes hold both phases (PhaseSplitOf).
void NoteOnlyLiquid(const netcdf::NetcdfFile& file, const std::vector<std::string>& variables,
                    WrfMetadata& metadata) {
  const bool known = file.NumberAttribute("", "MP_PHYSICS").value_or(0.0) > 0.0;
  const bool liquid = std::ranges::all_of(metadata.fields, [](Hydrometeor hydrometeor) {
    return hydrometeor == Hydrometeor::kCloud || hydrometeor == Hydrometeor::kRain;
  });
  if (known || !liquid || metadata.fields.empty()) return;
  metadata.assumptions.push_back(absl::StrCat(
      "Water in ", absl::StrJoin(variables, " and "), " is taken as liquid at all temperatures, ",
      "because the file has no variable of ice and does not name its scheme (MP_PHYSICS). If it is "
      "from WSM3 or Kessler's scheme, set MP_PHYSICS to 3 or 1."));
}

// Finds the hydrometeors. A variable that holds both phases gives two fields, unless the file has
// the frozen phase itself.
absl::Status FindFields(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  std::vector<std::string> found;
  for (const Hydrometeor hydrometeor : physics::kHydrometeors) {
    const std::string variable(WrfVariableOf(hydrometeor));
    if (!file.HasVariable(variable)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckVariable(file, layout, variable, layout.Layers(), kMixingRatio, Changes::kAtEachTime));
    found.push_back(variable);
    metadata.variables[physics::IndexOf(hydrometeor)] = variable;
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckScaleFactors(file, found, metadata.assumptions));
  THUNDERHEAD_RETURN_IF_ERROR(CheckCellMethods(file, found, metadata.assumptions));
  THUNDERHEAD_RETURN_IF_ERROR(FindMoreIce(file, metadata));
  const PhaseSplit split =
      PhaseSplitOf(static_cast<int>(file.NumberAttribute("", "MP_PHYSICS").value_or(0.0)));
  std::vector<std::string> shared;
  for (const Hydrometeor liquid : {Hydrometeor::kCloud, Hydrometeor::kRain}) {
    const std::string& variable = metadata.variables[physics::IndexOf(liquid)];
    std::string& frozen = metadata.variables[physics::IndexOf(FrozenPhaseOf(liquid))];
    if (split == PhaseSplit::kNone || variable.empty() || !frozen.empty()) continue;
    frozen = variable;
    shared.push_back(variable);
  }
  if (!shared.empty()) {
    metadata.split = split;
    metadata.assumptions.push_back(Explained(split, absl::StrJoin(shared, " and ")));
  }
  for (const Hydrometeor hydrometeor : physics::kHydrometeors) {
    if (!metadata.variables[physics::IndexOf(hydrometeor)].empty()) {
      metadata.fields.push_back(hydrometeor);
    }
  }
  NoteOnlyLiquid(file, found, metadata);
  if (!metadata.fields.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": has none of the variables ",
      absl::StrJoin(kHydrometeorVariables, ", ",
                    [](std::string* out, std::string_view name) { out->append(name); }),
      "; write at least one to the model's history output"));
}

// Finds the variables of particle sizes. Skips a variable of unexpected shape or units.
void FindSizes(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  for (const SizeName& name : kSizeNames) {
    const std::string variable(name.variable);
    volume::SizeVariable& size = metadata.sizes[physics::IndexOf(name.hydrometeor)];
    const bool drawn =
        std::ranges::find(metadata.fields, name.hydrometeor) != metadata.fields.end();
    if (!drawn || !size.name.empty() || !file.HasVariable(variable)) continue;
    // A number of particles of both phases says nothing about one phase.
    if (name.is_count && metadata.IsShared(name.hydrometeor)) continue;
    // The sizes of one category of ice say nothing about all categories together.
    if (name.hydrometeor == Hydrometeor::kIce && !metadata.more_ice.empty()) continue;
    const absl::Status fit =
        CheckVariable(file, layout, variable, layout.Layers(),
                      name.is_count ? kPerMass : kWrfLength, Changes::kAtEachTime);
    if (fit.ok()) {
      size = {variable, name.is_count};
    } else {
      spdlog::warn("particle sizes are not read: {}", std::string(fit.message()));
    }
  }
}

// Finds the variables of the air's motion. Skips a variable of unexpected shape or units.
void FindMotion(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const WrfLayout& layout = metadata.layout;
  const auto nx = static_cast<std::size_t>(metadata.cells.x);
  const auto ny = static_cast<std::size_t>(metadata.cells.y);
  const auto nz = static_cast<std::size_t>(metadata.cells.z);
  const auto fits = [&](const std::string& variable, const std::vector<std::size_t>& shape,
                        const WrfUnit& unit) {
    if (!file.HasVariable(variable)) return false;
    const absl::Status fit =
        CheckVariable(file, layout, variable, shape, unit, Changes::kAtEachTime);
    if (!fit.ok()) {
      spdlog::warn("the motion of the air is not read: {}", std::string(fit.message()));
    }
    return fit.ok();
  };
  for (const char* name : {"TKE", "QKE", "TKE_PBL", "TKE_2"}) {
    const bool at_interfaces =
        HasShape(file, layout, name, layout.Interfaces(), Changes::kAtEachTime);
    if (!fits(name, at_interfaces ? layout.Interfaces() : layout.Layers(), kEnergy)) continue;
    metadata.energy = {name, at_interfaces, std::string_view(name) == "QKE"};
    break;
  }
  // A restart file has two steps of each component; the second is the newer.
  for (const char* step : {"", "_2"}) {
    const std::string u = absl::StrCat("U", step);
    const std::string v = absl::StrCat("V", step);
    const std::string w = absl::StrCat("W", step);
    if (!fits(u, {nz, ny, nx + 1}, kVelocity) || !fits(v, {nz, ny + 1, nx}, kVelocity) ||
        !fits(w, layout.Interfaces(), kVelocity)) {
      continue;
    }
    metadata.wind = {u, v, w};
    break;
  }
}

// Returns the microphysics scheme by its number in WRF.
physics::Microphysics MicrophysicsOf(const netcdf::NetcdfFile& file) {
  const double scheme = file.NumberAttribute("", "MP_PHYSICS").value_or(0.0);
  if (scheme == 8.0) return physics::Microphysics::kThompson;
  if (scheme != 6.0) return physics::Microphysics::kUnknown;
  const bool with_hail = file.NumberAttribute("", "HAIL_OPT").value_or(0.0) == 1.0;
  return with_hail ? physics::Microphysics::kWsm6WithHail : physics::Microphysics::kWsm6;
}

// Returns the model's name: "WRF V4.7.1" for " OUTPUT FROM WRF V4.7.1 MODEL".
std::string ModelName(const netcdf::NetcdfFile& file) {
  const std::string title = file.TextAttribute("", "TITLE").value_or("");
  absl::string_view name = absl::StripAsciiWhitespace(title);
  name = absl::StripPrefix(name, "OUTPUT FROM ");
  name = absl::StripSuffix(name, " MODEL");
  return std::string(absl::StripAsciiWhitespace(name));
}

// Calls `use` with the places of the columns at a record, if they differ from those at the first.
absl::Status WithMovedPlaces(const WrfMetadata& metadata, const netcdf::NetcdfFile& file,
                             std::size_t record,
                             const std::function<absl::Status(const ColumnPlaces&)>& use) {
  if (metadata.even == nullptr || record == 0) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::optional<ColumnPlaces> places,
      ReadWrfColumns(file, metadata.columns, glm::ivec2(metadata.cells), record));
  if (!places.has_value() || *places == metadata.places) return absl::OkStatus();
  return base::Annotate(use(*places), absl::StrCat(metadata.path, ": record ", record));
}

// Reads the projection at each record, if the domain moves.
absl::Status ReadProjections(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  WrfPlace& place = metadata.place;
  place.projections.assign(place.middles.size(), place.projection);
  for (std::size_t record = 1; record < place.projections.size(); ++record) {
    THUNDERHEAD_RETURN_IF_ERROR(
        WithMovedPlaces(metadata, file, record, [&](const ColumnPlaces& places) -> absl::Status {
          THUNDERHEAD_ASSIGN_OR_RETURN(
              place.projections[record],
              ProjectionOfEven(places, {.columns = metadata.even->columns}));
          return absl::OkStatus();
        }));
  }
  return absl::OkStatus();
}

// Converts DX and DY, which are lengths on the model's map, to true distances by the map factors.
// They are used if the places of the columns are not known.
absl::Status DivideByMapFactors(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  // Factors this close to 1 change no distance noticeably.
  constexpr double kUnnoticed = 1e-3;
  WrfPlace& place = metadata.place;
  if (place.idealised || std::min(metadata.dx_m, metadata.dy_m) == 0.0) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::optional<WrfMapFactors> found,
      FindMapFactors(file, glm::ivec2(metadata.cells), metadata.place.middle));
  if (!found.has_value()) {
    metadata.assumptions.emplace_back(
        "The distances between columns are DX and DY, which are lengths on the model's map. True "
        "distances can differ, and the file has neither usable XLAT and XLONG nor MAPFAC_M, nor a "
        "projection with CEN_LAT.");
    return absl::OkStatus();
  }
  const glm::dvec2 off = glm::abs(found->factors - 1.0);
  if (std::max(off.x, off.y) < kUnnoticed) return absl::OkStatus();
  metadata.nominal_m /= found->factors;
  metadata.dx_m = metadata.nominal_m.x;
  metadata.dy_m = metadata.nominal_m.y;
  if (!place.projection.empty()) {
    place.projection = WithTrueScaleAt(place.projection, *place.middle, place.middle->latitude_deg);
  }
  metadata.assumptions.push_back(
      absl::StrCat("The distances between columns are DX and DY divided by ", found->from, "."));
  return absl::OkStatus();
}

// Measures the true distances between columns, and finds columns that are even.
absl::Status MeasureColumns(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  metadata.nominal_m = metadata.on_map_m = {metadata.dx_m, metadata.dy_m};
  WrfPlace& place = metadata.place;
  if (!place.middle.has_value() || place.latitude.empty())
    return DivideByMapFactors(file, metadata);
  metadata.columns = {place.latitude, place.longitude, place.projection};
  const glm::ivec2 columns(metadata.cells);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<ColumnPlaces> places,
                               ReadWrfColumns(file, metadata.columns, columns, 0));
  if (!places.has_value()) return DivideByMapFactors(file, metadata);
  absl::StatusOr<EvenColumns> even = MakeEven(*places);
  if (!even.ok()) return base::Annotate(even.status(), file.Path());
  metadata.places = *places;
  place.projection = even->projection;
  metadata.even = std::make_shared<const EvenColumns>(*std::move(even));
  const glm::dvec2 distances_m = metadata.DistancesOf(metadata.even.get());
  metadata.dx_m = distances_m.x;
  metadata.dy_m = distances_m.y;
  return ReadProjections(file, metadata);
}

}  // namespace

std::string_view WrfVariableOf(Hydrometeor hydrometeor) {
  return kHydrometeorVariables[physics::IndexOf(hydrometeor)];
}

glm::dvec2 WrfMetadata::DistancesOf(const EvenColumns* even_at_record) const {
  if (even_at_record == nullptr) return nominal_m;
  // Places are stored as floats. They do not give lengths more accurately than this. Over the whole
  // domain a difference counts if it is a tenth of a column.
  constexpr double kAccuracy = 1e-3;
  constexpr double kColumns = 0.1;
  const glm::dvec2 measured_m = even_at_record->ModelSpacing_m();
  const glm::dvec2 off = glm::abs(nominal_m / measured_m - 1.0);
  const auto differs = [&](int axis) {
    return off[axis] > kAccuracy || off[axis] * even_at_record->model_columns[axis] > kColumns;
  };
  return {differs(0) ? measured_m.x : nominal_m.x, differs(1) ? measured_m.y : nominal_m.y};
}

bool WrfMetadata::IsShared(Hydrometeor hydrometeor) const {
  const std::string& variable = variables[physics::IndexOf(hydrometeor)];
  return !variable.empty() && std::ranges::count(variables, variable) > 1;
}

absl::StatusOr<std::shared_ptr<const EvenColumns>> EvenColumnsAt(const WrfMetadata& metadata,
                                                                 const netcdf::NetcdfFile& file,
                                                                 std::size_t record) {
  std::shared_ptr<const EvenColumns> even = metadata.even;
  THUNDERHEAD_RETURN_IF_ERROR(
      WithMovedPlaces(metadata, file, record, [&](const ColumnPlaces& places) -> absl::Status {
        THUNDERHEAD_ASSIGN_OR_RETURN(EvenColumns moved,
                                     MakeEven(places, {.columns = metadata.even->columns}));
        even = std::make_shared<const EvenColumns>(std::move(moved));
        return absl::OkStatus();
      }));
  return even;
}

absl::StatusOr<WrfMetadata> ReadWrfMetadata(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(path));
  return ReadWrfMetadata(file);
}

absl::StatusOr<WrfMetadata> ReadWrfMetadata(const netcdf::NetcdfFile& file) {
  for (const std::optional<std::string>& why : {WhyOnlyRelated(file), WhyOnlyTile(file)}) {
    if (why.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": ", *why));
    }
  }
  WrfMetadata metadata;
  metadata.path = file.Path();
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.layout, FindWrfLayout(file));
  metadata.cells = metadata.layout.cells;
  ReadSpacing(file, metadata);
  THUNDERHEAD_ASSIGN_OR_RETURN(WrfTimes times, ReadWrfTimes(file, metadata.layout));
  metadata.times = std::move(times.times);
  metadata.simulation_start = std::move(times.run);
  metadata.assumptions = std::move(times.assumptions);
  THUNDERHEAD_RETURN_IF_ERROR(FindHeights(file, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(FindAir(file, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(FindFields(file, metadata));
  metadata.has_terrain = file.HasVariable("HGT");
  if (metadata.has_terrain) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(
        file, metadata.layout, "HGT", metadata.layout.Columns(), kWrfLength, Changes::kNever));
  }
  FindSizes(file, metadata);
  FindMotion(file, metadata);
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.place, ReadWrfPlace(file, metadata.layout));
  std::ranges::copy(metadata.place.assumptions, std::back_inserter(metadata.assumptions));
  THUNDERHEAD_RETURN_IF_ERROR(MeasureColumns(file, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(CheckSpacing(file, metadata));
  if (metadata.place.middle.has_value()) metadata.land = FindLand(file, metadata.layout);
  metadata.model = ModelName(file);
  metadata.microphysics = MicrophysicsOf(file);
  metadata.domain = DomainOf(file);
  return metadata;
}

}  // namespace thunderhead::storm_files
