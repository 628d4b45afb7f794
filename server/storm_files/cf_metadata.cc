#include "storm_files/cf_metadata.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/date_time.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kMetresPerDegree = kCfEarthRadius_m * std::numbers::pi / 180.0;

// Finds the axes among a variable's dimensions.
absl::StatusOr<CfVariable> Arrange(const netcdf::NetcdfFile& file, const std::string& variable) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> names, file.Dimensions(variable));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(variable));
  CfVariable arranged;
  arranged.name = variable;
  arranged.dimensions = static_cast<int>(names.size());
  for (int i = 0; i < arranged.dimensions; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto direction = DirectionOf(DescribeCf(file, names[at]));
    int* place = nullptr;
    if (direction == CfDirection::kX) place = &arranged.x;
    if (direction == CfDirection::kY) place = &arranged.y;
    if (direction == CfDirection::kZ) place = &arranged.z;
    if (direction == CfDirection::kTime) place = &arranged.time;
    if (place != nullptr && *place < 0) {
      *place = i;
    } else if (shape[at] != 1) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", variable, " has a dimension ", names[at], " of ", shape[at],
          " beside x, y, z and time; extract one of them, or give its coordinate an axis "
          "attribute"));
    }
  }
  const char* lacking = arranged.x < 0 ? "x" : arranged.y < 0 ? "y" : "z";
  if (arranged.x >= 0 && arranged.y >= 0 && arranged.z >= 0) return arranged;
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": none of the dimensions (", absl::StrJoin(names, ", "), ") of ",
                   variable, " is known as ", lacking,
                   "; name it so, or give its coordinate variable the attribute axis"));
}

std::vector<CfDescription> Describe(const netcdf::NetcdfFile& file) {
  std::vector<CfDescription> descriptions;
  for (const std::string& name : file.Variables()) descriptions.push_back(DescribeCf(file, name));
  return descriptions;
}

absl::Status WrongUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                        const std::string& wanted) {
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", variable.name,
      variable.units.empty() ? " has no units" : absl::StrCat(" has units '", variable.units, "'"),
      " where ", wanted, " is needed; convert it, or add its units attribute"));
}

absl::Status CheckQuantityUnits(const netcdf::NetcdfFile& file, const CfDescription& variable,
                                const CfQuantity& quantity) {
  if (quantity.known_units) return absl::OkStatus();
  return WrongUnits(
      file, variable,
      quantity.quantity == volume::Quantity::kExtinction ? "'m-1'" : "'kg kg-1' or 'kg m-3'");
}

// Finds the hydrometeors, or the extinction alone if there is one, because it includes all of them.
absl::Status FindFields(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                        CfMetadata* metadata) {
  std::vector<CfField>& fields = metadata->fields;
  for (const CfDescription& variable : variables) {
    const std::optional<CfQuantity> quantity = QuantityOf(variable);
    if (!quantity.has_value()) continue;
    // Variables without a height axis, such as column totals, may have the same names.
    THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(variable.name));
    if (shape.size() < 3) continue;
    THUNDERHEAD_RETURN_IF_ERROR(CheckQuantityUnits(file, variable, *quantity));
    THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged, Arrange(file, variable.name));
    const auto same = [&](const CfField& field) {
      return field.quantity.hydrometeor == quantity->hydrometeor &&
             (field.quantity.quantity == volume::Quantity::kExtinction) ==
                 (quantity->quantity == volume::Quantity::kExtinction);
    };
    if (const auto first = std::ranges::find_if(fields, same); first != fields.end()) {
      spdlog::info("{}: {} is left out: {} says the same", file.Path(), variable.name,
                   first->variable.name);
      continue;
    }
    fields.push_back({std::move(arranged), *quantity});
  }
  const auto extinction = std::ranges::find_if(fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kExtinction;
  });
  if (extinction != fields.end() && fields.size() > 1) {
    spdlog::info("{}: only its extinction is used, not its hydrometeors", file.Path());
    fields = {*extinction};
  }
  std::ranges::stable_sort(fields, {}, [](const CfField& field) {
    return physics::IndexOf(field.quantity.hydrometeor);
  });
  return absl::OkStatus();
}

bool Has(const CfMetadata& metadata, AirVariable variable) {
  return std::ranges::any_of(
      metadata.air, [variable](const CfAirField& field) { return field.air.variable == variable; });
}

// Finds the variables needed to convert mixing ratios to masses per volume.
absl::Status FindAir(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                     CfMetadata* metadata) {
  const auto ratio = std::ranges::find_if(metadata->fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kMixingRatio;
  });
  if (ratio == metadata->fields.end()) return absl::OkStatus();
  for (const CfDescription& variable : variables) {
    const std::optional<CfAir> air = AirVariableOf(variable);
    if (!air.has_value() || Has(*metadata, air->variable)) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(variable.name));
    if (shape.size() < 3) continue;
    if (!air->known_units) return WrongUnits(file, variable, "kg m-3, Pa, K or kg kg-1");
    if (PlainUnits(variable.units).empty()) {
      spdlog::warn("{}: {} has no units; taken to be in kg m-3, Pa, K or kg kg-1", file.Path(),
                   variable.name);
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged, Arrange(file, variable.name));
    metadata->air.push_back({std::move(arranged), *air});
  }
  const bool warm = Has(*metadata, AirVariable::kTemperature) ||
                    Has(*metadata, AirVariable::kPotentialTemperature);
  if (Has(*metadata, AirVariable::kDensity) || (Has(*metadata, AirVariable::kPressure) && warm)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": ", ratio->variable.name,
      " is per kg of air, and the file lacks the air's density; add air_density (kg m-3), or "
      "air_pressure (Pa) with air_temperature (K), or give masses in kg m-3"));
}

absl::Status ReadAxes(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  const CfVariable& first = metadata->fields.front().variable;
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto names, file.Dimensions(first.name));
  auto& [x, y, z] = metadata->axes;
  const auto read = [&](int place, CfDirection direction, const CfSizes& sizes,
                        CfAxis* axis) -> absl::Status {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        *axis, ReadCfAxis(file, names[static_cast<std::size_t>(place)], direction, sizes));
    return absl::OkStatus();
  };
  const bool single_y = file.DimensionLength(names[static_cast<std::size_t>(first.y)]) == 1U;
  CfSizes sizes{kMetresPerDegree, 0.0};
  // If the domain is only one cell wide along one horizontal axis, that width is assumed to be the
  // cell size along the other axis.
  if (single_y && read(first.x, CfDirection::kX, sizes, &x).ok()) sizes.single_cell_m = x.spacing_m;
  THUNDERHEAD_RETURN_IF_ERROR(read(first.y, CfDirection::kY, sizes, &y));
  const double latitude_deg = y.middle_deg.value_or(0.0);
  sizes = {kMetresPerDegree * std::cos(latitude_deg * std::numbers::pi / 180.0), y.spacing_m};
  THUNDERHEAD_RETURN_IF_ERROR(read(first.x, CfDirection::kX, sizes, &x));
  THUNDERHEAD_RETURN_IF_ERROR(read(first.z, CfDirection::kZ, sizes, &z));
  return absl::OkStatus();
}

// Checks that the variable has the same x, y and z dimensions as the first field.
absl::Status CheckSameAxes(const netcdf::NetcdfFile& file, const CfVariable& variable,
                           const CfMetadata& metadata) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto names, file.Dimensions(variable.name));
  const std::array places = {variable.x, variable.y, variable.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string& name = names[static_cast<std::size_t>(places[axis])];
    if (name == metadata.axes[axis].dimension) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", variable.name, " lies on ", name, " where ",
                     metadata.fields.front().variable.name, " lies on ",
                     metadata.axes[axis].dimension, "; put all on one grid"));
  }
  return absl::OkStatus();
}

// Returns the dimensions of a variable of wind or turbulent energy. An error says why the variable
// cannot be used.
absl::StatusOr<CfVariable> ArrangeWind(const netcdf::NetcdfFile& file,
                                       const CfDescription& variable, const CfWind& wind,
                                       const CfMetadata& metadata) {
  if (!wind.known_units) {
    return WrongUnits(file, variable,
                      wind.variable == WindVariable::kTurbulentEnergy ? "m2 s-2" : "m s-1");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged, Arrange(file, variable.name));
  THUNDERHEAD_RETURN_IF_ERROR(CheckSameAxes(file, arranged, metadata));
  return arranged;
}

// Finds the wind and the turbulent energy, if the file has them on the fields' own grid.
void FindWind(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
              CfMetadata* metadata) {
  const auto has = [&](WindVariable wind) {
    return std::ranges::find(metadata->wind, wind, &CfWindField::wind) != metadata->wind.end();
  };
  for (const CfDescription& variable : variables) {
    const std::optional<CfWind> wind = WindVariableOf(variable);
    if (!wind.has_value() || has(wind->variable)) continue;
    const auto shape = file.Shape(variable.name);
    if (!shape.ok() || shape->size() < 3) continue;
    absl::StatusOr<CfVariable> arranged = ArrangeWind(file, variable, *wind, *metadata);
    if (arranged.ok()) {
      metadata->wind.push_back({*std::move(arranged), wind->variable});
    } else {
      spdlog::warn("the motion of the air is read without {}: {}", variable.name,
                   std::string(arranged.status().message()));
    }
  }
  if (has(WindVariable::kEastward) && has(WindVariable::kNorthward) && has(WindVariable::kUpward)) {
    return;
  }
  std::erase_if(metadata->wind, [](const CfWindField& field) {
    return field.wind != WindVariable::kTurbulentEnergy;
  });
}

// Returns the start of a storm without a date. It counts as idealised and begins in year 1, as in
// WRF.
absl::Time IdealisedStart() {
  return absl::FromCivil(absl::CivilSecond(1, 1, 1), absl::UTCTimeZone());
}

// Returns the first day on which CF's default calendar is Gregorian. Before it, that calendar is
// Julian, but all dates here are Gregorian.
absl::Time FirstGregorianDay() {
  return absl::FromCivil(absl::CivilSecond(1582, 10, 15), absl::UTCTimeZone());
}

absl::Status CheckCalendar(const netcdf::NetcdfFile& file, const std::string& name,
                           absl::Time origin, const std::vector<absl::Time>& times) {
  const std::string calendar = absl::AsciiStrToLower(file.TextOrEmpty(name, "calendar"));
  if (calendar == "proleptic_gregorian") return absl::OkStatus();
  if (!calendar.empty() && calendar != "standard" && calendar != "gregorian") {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", name, " counts in the calendar '", calendar,
                     "'; write its times in the calendar 'standard'"));
  }
  const bool begins_julian = origin < FirstGregorianDay();
  const bool crosses = std::ranges::any_of(times, [begins_julian](absl::Time time) {
    return (time < FirstGregorianDay()) != begins_julian;
  });
  if (!crosses) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": the coordinate ", name, " counts across the change of calendars in 1582; ",
      "count from a later date, or set the attribute calendar to 'proleptic_gregorian'"));
}

// Returns the units of the time coordinate. Returns nothing if the coordinate has no units and
// there is only one time, for which no units are needed.
absl::StatusOr<std::optional<TimeUnits>> ReadTimeUnits(const netcdf::NetcdfFile& file,
                                                       const std::string& name,
                                                       std::size_t records) {
  const CfDescription time = DescribeCf(file, name);
  const bool given = !absl::StripAsciiWhitespace(time.units).empty();
  if (!given && records == 1) return std::optional<TimeUnits>();
  std::optional<TimeUnits> units = ParseTimeUnits(time.units);
  if (units.has_value()) return units;
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": the coordinate ", name, " has ",
      given ? absl::StrCat("units '", absl::CEscape(time.units), "'") : "no units",
      " where 'seconds since 2013-05-20 18:00:00' or the like is needed (s, min, h or days; an ",
      "offset such as +05:30 may follow); correct them"));
}

absl::Status ReadCfTimes(const netcdf::NetcdfFile& file, CfMetadata* metadata) {
  const CfVariable& first = metadata->fields.front().variable;
  if (first.time < 0) {
    metadata->times = {IdealisedStart()};
    return absl::OkStatus();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto names, file.Dimensions(first.name));
  const std::string& name = names[static_cast<std::size_t>(first.time)];
  const std::size_t records = file.DimensionLength(name).value_or(0);
  if (records == 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": holds no times yet; the model may still be writing it: try again later"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckRecords(file.Path(), records));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<TimeUnits> units,
                               ReadTimeUnits(file, name, records));
  if (!units.has_value()) {
    spdlog::warn("{}: its only time has no units; taken as that of an idealised run", file.Path());
    metadata->times = {IdealisedStart()};
    return absl::OkStatus();
  }
  if (!units->origin.has_value()) {
    spdlog::warn("{}: {} counts from no date; taken as the time of an idealised run", file.Path(),
                 name);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values, file.ReadDoubles(name));
  if (values.size() != records) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ", name, " has ",
                                                   values.size(), " values for ", records,
                                                   " times; it must have one each"));
  }
  for (const double value : values) {
    if (!std::isfinite(value)) {
      return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ", name,
                                                     " has missing values; fill them in"));
    }
    metadata->times.push_back(units->origin.value_or(IdealisedStart()) +
                              absl::Seconds(value * units->seconds));
  }
  if (!units->origin.has_value()) return absl::OkStatus();
  return CheckCalendar(file, name, *units->origin, metadata->times);
}

// Finds the variable with the height of the ground. The height is optional, so a variable that
// cannot be read is ignored.
std::optional<CfSurface> FindSurface(const netcdf::NetcdfFile& file,
                                     const std::vector<CfDescription>& variables,
                                     const CfMetadata& metadata) {
  const std::vector<std::string> on = {metadata.axes[1].dimension, metadata.axes[0].dimension};
  for (const CfDescription& variable : variables) {
    if (variable.standard_name != "surface_altitude") continue;
    const std::optional<double> metres = MetresIn(variable.units);
    const auto names = file.Dimensions(variable.name);
    if (metres.has_value() && names.ok() && *names == on) return CfSurface{variable.name, *metres};
    spdlog::warn("{}: {} (units '{}') is not read; it must be on ({}), in m or km", file.Path(),
                 variable.name, variable.units, absl::StrJoin(on, ", "));
  }
  return std::nullopt;
}

}  // namespace

bool LooksLikeCf(const netcdf::NetcdfFile& file) {
  return std::ranges::any_of(Describe(file), [](const CfDescription& variable) {
    return QuantityOf(variable).has_value();
  });
}

absl::StatusOr<CfMetadata> ReadCfMetadata(const netcdf::NetcdfFile& file) {
  const std::vector<CfDescription> variables = Describe(file);
  CfMetadata metadata;
  metadata.path = file.Path();
  THUNDERHEAD_RETURN_IF_ERROR(FindFields(file, variables, &metadata));
  if (metadata.fields.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(),
                     ": no variable on x, y and z is a hydrometeor (by standard name, e.g. "
                     "mass_concentration_of_cloud_liquid_water_in_air) or 'extinction' (m-1); "
                     "add one"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(ReadAxes(file, &metadata));
  THUNDERHEAD_RETURN_IF_ERROR(FindAir(file, variables, &metadata));
  for (const CfField& field : metadata.fields) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckSameAxes(file, field.variable, metadata));
  }
  for (const CfAirField& field : metadata.air) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckSameAxes(file, field.variable, metadata));
  }
  FindWind(file, variables, &metadata);
  THUNDERHEAD_RETURN_IF_ERROR(ReadCfTimes(file, &metadata));
  metadata.surface = FindSurface(file, variables, metadata);
  metadata.source = file.TextAttribute("", "title").value_or("");
  if (metadata.source.empty()) metadata.source = file.TextAttribute("", "source").value_or("");
  return metadata;
}

}  // namespace thunderhead::storm_files
