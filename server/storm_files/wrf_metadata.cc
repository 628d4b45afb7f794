#include "storm_files/wrf_metadata.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/date_time.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

constexpr std::array<std::string_view, physics::kHydrometeorCount> kHydrometeorVariables = {
    "QCLOUD", "QRAIN", "QICE", "QSNOW", "QGRAUP", "QHAIL"};

// The accepted spellings of a unit, without blanks, stars, carets, dots and brackets.
struct Unit {
  std::string_view name;
  std::array<std::string_view, 4> spellings;
};
constexpr Unit kMixingRatio = {"kg kg-1", {"kgkg-1", "kg/kg", "kg-1kg", "1"}};
constexpr Unit kPressure = {"Pa", {"Pa", "pascal", "pascals", "Nm-2"}};
constexpr Unit kGeopotential = {"m2 s-2", {"m2s-2", "m2/s2", "Jkg-1", "J/kg"}};
constexpr Unit kEnergy = kGeopotential;
constexpr Unit kVelocity = {"m s-1", {"ms-1", "m/s", "meters/s", "metres/s"}};
constexpr Unit kTemperature = {"K", {"K", "kelvin", "Kelvin", "degK"}};
constexpr Unit kLength = {"m", {"m", "meter", "meters", "metres"}};
constexpr Unit kPerMass = {"kg-1", {"kg-1", "/kg", "#kg-1", "#/kg"}};
constexpr Unit kShare = {"1", {"1", "-", "fraction", "dimensionless"}};
constexpr Unit kPercent = {"%", {"%", "percent"}};
constexpr Unit kNorth = {"degree_north", {"degreenorth", "degreesnorth", "degree", "degrees"}};
constexpr Unit kEast = {"degree_east", {"degreeeast", "degreeseast", "degree", "degrees"}};

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

absl::Status CheckUnits(const netcdf::NetcdfFile& file, const std::string& variable,
                        const Unit& unit) {
  const std::string units = file.TextOrEmpty(variable, "units");
  std::string spelling = units;
  std::erase_if(spelling, [](char c) { return c == ' ' || c == '*' || c == '^' || c == '.'; });
  std::erase_if(spelling, [](char c) { return c == '(' || c == ')' || c == '_'; });
  if (spelling.empty() || std::ranges::find(unit.spellings, spelling) != unit.spellings.end()) {
    return absl::OkStatus();
  }
  const std::string_view wanted = unit.name;
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": ", variable, " has units '", units, "' where '",
                   std::string(wanted), "' is needed; convert it (and its units attribute) first"));
}

// Returns `shape` as text for errors.
std::string AsText(const std::vector<std::size_t>& shape) {
  return absl::StrCat("(", absl::StrJoin(shape, ", "), ")");
}

absl::Status CheckVariable(const netcdf::NetcdfFile& file, const std::string& variable,
                           const std::vector<std::size_t>& shape, const Unit& unit) {
  if (!file.HasVariable(variable)) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": has no variable ", variable,
        ", which is needed; write it to the model's history output, or extract it as well"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> actual, file.Shape(variable));
  if (actual != shape) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", variable, " has dimensions ", AsText(actual), " where ",
                     AsText(shape), " are needed (time, levels, south-north, west-east); ",
                     "give the model's own output file"));
  }
  return CheckUnits(file, variable, unit);
}

absl::StatusOr<int> Length(const netcdf::NetcdfFile& file, const std::string& dimension) {
  const std::optional<std::size_t> length = file.DimensionLength(dimension);
  if (!length.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": has no dimension ", dimension,
                     ", so it is no WRF output; give a history file of the model (wrfout_...)"));
  }
  constexpr std::size_t kMax = 100'000;
  if (*length < 1 || *length > kMax) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": dimension ", dimension, " is ",
                                                   *length, "; 1 to ", kMax, " can be read"));
  }
  return static_cast<int>(*length);
}

absl::Status ReadGrid(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.cells.x, Length(file, "west_east"));
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.cells.y, Length(file, "south_north"));
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.cells.z, Length(file, "bottom_top"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const int interfaces, Length(file, "bottom_top_stag"));
  if (interfaces != metadata.cells.z + 1) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": bottom_top_stag is ", interfaces,
                                                   " where bottom_top + 1 = ", metadata.cells.z + 1,
                                                   " is needed; extract all levels"));
  }
  const std::pair<const char*, double*> spacings[] = {{"DX", &metadata.dx_m},
                                                      {"DY", &metadata.dy_m}};
  for (const auto& [name, spacing_m] : spacings) {
    *spacing_m = file.NumberAttribute("", name).value_or(0.0);
    if (!(*spacing_m > 0.0) || !std::isfinite(*spacing_m)) {
      return absl::InvalidArgumentError(
          absl::StrCat(file.Path(), ": the global attribute ", name,
                       " (metres, above zero) is missing or wrong; add it"));
    }
  }
  metadata.nominal_m = {metadata.dx_m, metadata.dy_m};
  return absl::OkStatus();
}

// Parses a row of Times. Returns nothing for a row that is shorter than a time with seconds,
// because WRF has only partly written such a row.
std::optional<absl::Time> ParseWrfTime(const std::string& text) {
  constexpr std::size_t kWhole = std::string_view("2013-05-20_20:00:00").size();
  if (absl::StripAsciiWhitespace(text).size() < kWhole) return std::nullopt;
  return ParseDateTime(text);
}

// Returns when the run began, by the attribute `name`, or nothing if the file does not have it.
absl::StatusOr<std::optional<absl::Time>> ReadStart(const netcdf::NetcdfFile& file,
                                                    const std::string& name) {
  const std::string text = file.TextOrEmpty("", name);
  if (text.empty()) return std::optional<absl::Time>();
  std::optional<absl::Time> start = ParseWrfTime(text);
  if (!start.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the attribute ", name, " is '", absl::CEscape(text),
                     "', not a date like 2013-05-20_20:00:00; correct it"));
  }
  return start;
}

absl::Status NoTimes(const netcdf::NetcdfFile& file) {
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": holds no times yet; the model may still be writing it: try ",
                   "again when it has finished"));
}

// Returns the units of XTIME. The units are minutes since the start of the run unless the file says
// otherwise.
absl::StatusOr<TimeUnits> ReadXtimeUnits(const netcdf::NetcdfFile& file) {
  const std::string text = file.TextOrEmpty("XTIME", "units");
  const std::optional<TimeUnits> units = ParseTimeUnits(text.empty() ? "minutes" : text);
  if (!units.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": XTIME has units '", absl::CEscape(text),
                     "' where 'minutes since 2013-05-20 12:00:00' or the like is needed; correct "
                     "them"));
  }
  if (units->origin.has_value()) return *units;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::optional<absl::Time> start,
                               ReadStart(file, "SIMULATION_START_DATE"));
  if (!start.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(start, ReadStart(file, "START_DATE"));
  }
  return TimeUnits{units->seconds, start};
}

// Returns the times from the variable XTIME, for files without the variable Times.
absl::StatusOr<std::vector<absl::Time>> TimesFromXtime(const netcdf::NetcdfFile& file) {
  TimeUnits units;
  if (file.HasVariable("XTIME")) {
    THUNDERHEAD_ASSIGN_OR_RETURN(units, ReadXtimeUnits(file));
  }
  if (!units.origin.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": has no variable Times (nor XTIME with the attribute ",
                     "SIMULATION_START_DATE); extract Times as well"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape("XTIME"));
  if (shape.size() != 1) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": XTIME has dimensions ", AsText(shape), ", not (time)"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values, file.ReadDoubles("XTIME"));
  std::vector<absl::Time> times;
  for (const double value : values) {
    if (!std::isfinite(value)) return NoTimes(file);
    times.push_back(*units.origin + absl::Seconds(std::round(value * units.seconds)));
  }
  return times;
}

absl::StatusOr<std::vector<absl::Time>> ReadWrfTimes(const netcdf::NetcdfFile& file) {
  const std::size_t records = file.DimensionLength("Time").value_or(0);
  if (records == 0) return NoTimes(file);
  THUNDERHEAD_RETURN_IF_ERROR(CheckRecords(file.Path(), records));
  std::vector<absl::Time> times;
  if (!file.HasVariable("Times")) {
    THUNDERHEAD_ASSIGN_OR_RETURN(times, TimesFromXtime(file));
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> rows, file.ReadRows("Times"));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::optional<absl::Time> time = ParseWrfTime(rows[i]);
      if (!time.has_value()) {
        return absl::DataLossError(absl::StrCat(
            file.Path(), ": Times of record ", i, " is '", absl::CEscape(rows[i]),
            "', not a date like 2013-05-20_20:00:00; try again if the model is still writing the ",
            "file, else correct it"));
      }
      times.push_back(*time);
    }
  }
  if (times.size() != records) {
    return absl::DataLossError(absl::StrCat(
        file.Path(), ": Times has ", times.size(), " records where the dimension Time has ",
        records, "; the model may still be writing the file: try again when it has finished"));
  }
  return times;
}

// Finds the variables of particle sizes. Skips a variable of unexpected shape or units.
void FindSizes(const netcdf::NetcdfFile& file, const std::vector<std::size_t>& in_layers,
               WrfMetadata& metadata) {
  for (const SizeName& name : kSizeNames) {
    const std::string variable(name.variable);
    volume::SizeVariable& size = metadata.sizes[physics::IndexOf(name.hydrometeor)];
    const bool drawn =
        std::ranges::find(metadata.fields, name.hydrometeor) != metadata.fields.end();
    if (!drawn || !size.name.empty() || !file.HasVariable(variable)) continue;
    const absl::Status fit =
        CheckVariable(file, variable, in_layers, name.is_count ? kPerMass : kLength);
    if (fit.ok()) {
      size = {variable, name.is_count};
    } else {
      spdlog::warn("particle sizes are not read: {}", std::string(fit.message()));
    }
  }
}

// Finds the variables of the air's motion. Skips a variable of unexpected shape or units.
void FindMotion(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const std::size_t records = metadata.times.size();
  const auto nx = static_cast<std::size_t>(metadata.cells.x);
  const auto ny = static_cast<std::size_t>(metadata.cells.y);
  const auto nz = static_cast<std::size_t>(metadata.cells.z);
  const auto fits = [&](const std::string& variable, const std::vector<std::size_t>& shape,
                        const Unit& unit) {
    if (!file.HasVariable(variable)) return false;
    const absl::Status fit = CheckVariable(file, variable, shape, unit);
    if (!fit.ok()) {
      spdlog::warn("the motion of the air is not read: {}", std::string(fit.message()));
    }
    return fit.ok();
  };
  for (const char* name : {"TKE", "QKE", "TKE_PBL"}) {
    const absl::StatusOr<std::vector<std::size_t>> shape = file.Shape(name);
    const bool at_interfaces = shape.ok() && shape->size() == 4 && (*shape)[1] == nz + 1;
    if (!fits(name, {records, at_interfaces ? nz + 1 : nz, ny, nx}, kEnergy)) continue;
    metadata.energy = {name, at_interfaces, std::string_view(name) == "QKE"};
    break;
  }
  metadata.has_wind = fits("U", {records, nz, ny, nx + 1}, kVelocity) &&
                      fits("V", {records, nz, ny + 1, nx}, kVelocity) &&
                      fits("W", {records, nz + 1, ny, nx}, kVelocity);
}

absl::Status CheckVariables(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  const std::size_t records = metadata.times.size();
  const auto nx = static_cast<std::size_t>(metadata.cells.x);
  const auto ny = static_cast<std::size_t>(metadata.cells.y);
  const auto nz = static_cast<std::size_t>(metadata.cells.z);
  const std::vector<std::size_t> at_interfaces = {records, nz + 1, ny, nx};
  const std::vector<std::size_t> in_layers = {records, nz, ny, nx};
  for (const char* name : {"PH", "PHB"}) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, name, at_interfaces, kGeopotential));
  }
  for (const char* name : {"P", "PB"}) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, name, in_layers, kPressure));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, "T", in_layers, kTemperature));
  metadata.has_vapour = file.HasVariable("QVAPOR");
  if (metadata.has_vapour) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, "QVAPOR", in_layers, kMixingRatio));
  }
  metadata.has_terrain = file.HasVariable("HGT");
  if (metadata.has_terrain) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, "HGT", {records, ny, nx}, kLength));
  }
  for (Hydrometeor hydrometeor : physics::kHydrometeors) {
    const std::string variable(WrfVariableOf(hydrometeor));
    if (!file.HasVariable(variable)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(CheckVariable(file, variable, in_layers, kMixingRatio));
    metadata.fields.push_back(hydrometeor);
  }
  FindSizes(file, in_layers, metadata);
  FindMotion(file, metadata);
  if (!metadata.fields.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": has none of the variables ",
      absl::StrJoin(kHydrometeorVariables, ", ",
                    [](std::string* out, std::string_view name) { out->append(name); }),
      "; write at least one to the model's history output"));
}

// Returns the mean of `variable` over the cells around the middle of the domain. The values can be
// longitudes, so each is first brought to within 180 degrees of the first value.
absl::StatusOr<double> Middle(const netcdf::NetcdfFile& file, const std::string& variable,
                              const WrfMetadata& metadata) {
  const auto nx = static_cast<std::size_t>(metadata.cells.x);
  const auto ny = static_cast<std::size_t>(metadata.cells.y);
  const std::vector<std::size_t> expected = {metadata.times.size(), ny, nx};
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(variable));
  if (shape != expected) return std::numeric_limits<double>::quiet_NaN();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::vector<float> values,
      file.ReadPart(variable, {0, (ny - 1) / 2, (nx - 1) / 2}, {1, 2 - ny % 2, 2 - nx % 2}));
  double sum_deg = 0.0;
  for (const float value : values) {
    sum_deg += values[0] + std::remainder(static_cast<double>(value) - values[0], 360.0);
  }
  return sum_deg / static_cast<double>(values.size());
}

// Returns the projection of the grid as PROJ writes it, on WRF's sphere. Returns an empty text if
// the projection is missing, or if the grid is in degrees instead of metres.
std::string ProjectionOf(const netcdf::NetcdfFile& file) {
  const auto number = [&](const char* name) { return file.NumberAttribute("", name); };
  const std::optional<double> first_deg = number("TRUELAT1");
  const std::optional<double> middle_deg = number("STAND_LON");
  if (!first_deg.has_value() || !middle_deg.has_value()) return "";
  constexpr char kSphere[] = " +x_0=0 +y_0=0 +R=6370000 +units=m +no_defs";
  switch (static_cast<int>(number("MAP_PROJ").value_or(0.0))) {
    case 1:
      return absl::StrFormat("+proj=lcc +lat_1=%.10g +lat_2=%.10g +lat_0=%.10g +lon_0=%.10g%s",
                             *first_deg, number("TRUELAT2").value_or(*first_deg),
                             number("MOAD_CEN_LAT").value_or(*first_deg), *middle_deg, kSphere);
    case 2:
      return absl::StrFormat("+proj=stere +lat_0=%d +lat_ts=%.10g +lon_0=%.10g%s",
                             *first_deg < 0.0 ? -90 : 90, *first_deg, *middle_deg, kSphere);
    case 3:
      return absl::StrFormat("+proj=merc +lat_ts=%.10g +lon_0=%.10g%s", *first_deg, *middle_deg,
                             kSphere);
    default:
      return "";
  }
}

absl::Status ReadPlace(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  metadata.idealised = file.NumberAttribute("", "MAP_PROJ").value_or(1.0) == 0.0;
  if (metadata.idealised) return absl::OkStatus();
  if (!file.HasVariable("XLAT") || !file.HasVariable("XLONG")) return absl::OkStatus();
  absl::Status units = CheckUnits(file, "XLAT", kNorth);
  if (units.ok()) units = CheckUnits(file, "XLONG", kEast);
  if (!units.ok()) {
    spdlog::warn("the storm is shown without a place on Earth: {}", std::string(units.message()));
    return absl::OkStatus();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const double latitude_deg, Middle(file, "XLAT", metadata));
  THUNDERHEAD_ASSIGN_OR_RETURN(const double longitude_deg, Middle(file, "XLONG", metadata));
  if (!std::isfinite(latitude_deg) || !std::isfinite(longitude_deg)) return absl::OkStatus();
  metadata.idealised = latitude_deg == 0.0 && longitude_deg == 0.0;
  if (metadata.idealised) return absl::OkStatus();
  metadata.latitude_deg = latitude_deg;
  metadata.longitude_deg = std::remainder(longitude_deg, 360.0);
  metadata.projection = ProjectionOf(file);
  return absl::OkStatus();
}

// Measures the true distances between columns, and finds columns that are even.
absl::Status MeasureColumns(const netcdf::NetcdfFile& file, WrfMetadata& metadata) {
  if (!metadata.latitude_deg.has_value()) return absl::OkStatus();
  metadata.columns.projection = metadata.projection;
  const glm::ivec2 columns(metadata.cells);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<ColumnPlaces> places,
                               ReadWrfColumns(file, metadata.columns, columns, 0));
  if (!places.has_value()) return absl::OkStatus();
  absl::StatusOr<EvenColumns> even = MakeEven(*places);
  if (!even.ok()) return base::Annotate(even.status(), file.Path());
  metadata.places = *places;
  metadata.projection = even->projection;
  // Places are stored as floats. They do not give lengths more accurately than this.
  constexpr double kAccuracy = 1e-3;
  const glm::dvec2 factor = metadata.nominal_m / even->mean_m;
  if (std::abs(factor.x - 1.0) > kAccuracy) metadata.dx_m = even->mean_m.x;
  if (std::abs(factor.y - 1.0) > kAccuracy) metadata.dy_m = even->mean_m.y;
  metadata.even = std::make_shared<const EvenColumns>(*std::move(even));
  return absl::OkStatus();
}

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

// Finds the land-cover variables of a run with a place on Earth. Skips land use of an unknown
// scheme, and variables of unexpected shape or units.
WrfLand FindLand(const netcdf::NetcdfFile& file, const WrfMetadata& metadata) {
  WrfLand land;
  if (metadata.idealised || !metadata.latitude_deg.has_value()) return land;
  const auto find = [&](std::initializer_list<const char*> names,
                        const std::optional<Unit>& unit) -> std::string {
    const std::vector<std::size_t> columns = {metadata.times.size(),
                                              static_cast<std::size_t>(metadata.cells.y),
                                              static_cast<std::size_t>(metadata.cells.x)};
    for (const char* name : names) {
      if (!file.HasVariable(name)) continue;
      const absl::Status units =
          unit.has_value() ? CheckUnits(file, name, *unit) : absl::OkStatus();
      if (!units.ok()) {
        spdlog::warn("the ground is drawn without {}: {}", name, std::string(units.message()));
        continue;
      }
      const auto shape = file.Shape(name);
      if (shape.ok() && *shape == columns) return name;
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
  if (land.snow_share.empty()) land.snow_depth = find({"SNOWH"}, kLength);
  return land;
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

}  // namespace

std::string_view WrfVariableOf(Hydrometeor hydrometeor) {
  return kHydrometeorVariables[physics::IndexOf(hydrometeor)];
}

absl::StatusOr<WrfMetadata> ReadWrfMetadata(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(path));
  return ReadWrfMetadata(file);
}

absl::StatusOr<WrfMetadata> ReadWrfMetadata(const netcdf::NetcdfFile& file) {
  WrfMetadata metadata;
  metadata.path = file.Path();
  THUNDERHEAD_RETURN_IF_ERROR(ReadGrid(file, metadata));
  THUNDERHEAD_ASSIGN_OR_RETURN(metadata.times, ReadWrfTimes(file));
  THUNDERHEAD_RETURN_IF_ERROR(CheckVariables(file, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(ReadPlace(file, metadata));
  THUNDERHEAD_RETURN_IF_ERROR(MeasureColumns(file, metadata));
  metadata.land = FindLand(file, metadata);
  metadata.model = ModelName(file);
  metadata.microphysics = MicrophysicsOf(file);
  metadata.domain = static_cast<int>(file.NumberAttribute("", "GRID_ID").value_or(1.0));
  THUNDERHEAD_RETURN_IF_ERROR(ReadStart(file, "SIMULATION_START_DATE").status());
  metadata.simulation_start = file.TextOrEmpty("", "SIMULATION_START_DATE");
  return metadata;
}

}  // namespace thunderhead::storm_files
