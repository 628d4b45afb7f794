#include "storm_files/cf_names.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/strip.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

struct Named {
  std::string_view name;
  Hydrometeor hydrometeor;
};

// Substances X in standard names such as "mass_fraction_of_X_in_air" and "X_mixing_ratio".
constexpr std::array kSubstances = {
    Named{"cloud_liquid_water", Hydrometeor::kCloud},
    Named{"liquid_water", Hydrometeor::kCloud},
    Named{"cloud_water", Hydrometeor::kCloud},
    Named{"stratiform_cloud_liquid_water", Hydrometeor::kCloud},
    Named{"rain", Hydrometeor::kRain},
    Named{"rain_water", Hydrometeor::kRain},
    Named{"rainwater", Hydrometeor::kRain},
    Named{"liquid_precipitation", Hydrometeor::kRain},
    Named{"cloud_ice", Hydrometeor::kIce},
    Named{"stratiform_cloud_ice", Hydrometeor::kIce},
    Named{"ice", Hydrometeor::kIce},
    Named{"snow", Hydrometeor::kSnow},
    Named{"graupel", Hydrometeor::kGraupel},
    Named{"graupel_and_hail", Hydrometeor::kGraupel},
    Named{"hail", Hydrometeor::kHail},
};

// Variable names that cloud models commonly use, for variables without a standard name.
constexpr std::array kVariables = {
    Named{"qc", Hydrometeor::kCloud},       Named{"qcloud", Hydrometeor::kCloud},
    Named{"ql", Hydrometeor::kCloud},       Named{"clw", Hydrometeor::kCloud},
    Named{"lwc", Hydrometeor::kCloud},      Named{"qr", Hydrometeor::kRain},
    Named{"qrain", Hydrometeor::kRain},     Named{"rwc", Hydrometeor::kRain},
    Named{"qi", Hydrometeor::kIce},         Named{"qice", Hydrometeor::kIce},
    Named{"cli", Hydrometeor::kIce},        Named{"iwc", Hydrometeor::kIce},
    Named{"qs", Hydrometeor::kSnow},        Named{"qsnow", Hydrometeor::kSnow},
    Named{"swc", Hydrometeor::kSnow},       Named{"qg", Hydrometeor::kGraupel},
    Named{"qgraup", Hydrometeor::kGraupel}, Named{"qgraupel", Hydrometeor::kGraupel},
    Named{"qh", Hydrometeor::kHail},        Named{"qhail", Hydrometeor::kHail},
};

template <std::size_t count>
std::optional<Hydrometeor> Find(const std::array<Named, count>& table, std::string_view name) {
  const auto at = std::ranges::find(table, name, &Named::name);
  return at == table.end() ? std::nullopt : std::optional(at->hydrometeor);
}

bool IsOneOf(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

// Returns the substance in a standard name of an amount of water, and whether the amount is a
// fraction of moist air.
std::optional<CfQuantity> FromStandardName(const std::string& standard_name) {
  absl::string_view substance = standard_name;
  CfQuantity quantity;
  if (absl::ConsumePrefix(&substance, "mass_fraction_of_")) {
    quantity.of_moist_air = true;
    absl::ConsumeSuffix(&substance, "_in_air");
  } else if (absl::ConsumePrefix(&substance, "mass_concentration_of_")) {
    quantity.quantity = volume::Quantity::kMassConcentration;
    absl::ConsumeSuffix(&substance, "_in_air");
  } else if (!absl::ConsumeSuffix(&substance, "_mixing_ratio")) {
    return std::nullopt;
  }
  const auto hydrometeor = Find(kSubstances, {substance.data(), substance.size()});
  if (!hydrometeor.has_value()) return std::nullopt;
  quantity.hydrometeor = *hydrometeor;
  return quantity;
}

struct Scale {
  std::string_view units;
  volume::Quantity quantity;
  double scale;
};

constexpr std::array kScales = {
    Scale{"kgkg-1", volume::Quantity::kMixingRatio, 1.0},
    Scale{"kg/kg", volume::Quantity::kMixingRatio, 1.0},
    Scale{"1", volume::Quantity::kMixingRatio, 1.0},
    Scale{"gkg-1", volume::Quantity::kMixingRatio, 1e-3},
    Scale{"g/kg", volume::Quantity::kMixingRatio, 1e-3},
    Scale{"kgm-3", volume::Quantity::kMassConcentration, 1.0},
    Scale{"kg/m3", volume::Quantity::kMassConcentration, 1.0},
    Scale{"gm-3", volume::Quantity::kMassConcentration, 1e-3},
    Scale{"g/m3", volume::Quantity::kMassConcentration, 1e-3},
    Scale{"mgm-3", volume::Quantity::kMassConcentration, 1e-6},
    Scale{"mg/m3", volume::Quantity::kMassConcentration, 1e-6},
    Scale{"m-1", volume::Quantity::kExtinction, 1.0},
    Scale{"1/m", volume::Quantity::kExtinction, 1.0},
    Scale{"/m", volume::Quantity::kExtinction, 1.0},
    Scale{"km-1", volume::Quantity::kExtinction, 1e-3},
    Scale{"1/km", volume::Quantity::kExtinction, 1e-3},
};

void ApplyUnits(const std::string& units, CfQuantity* quantity) {
  const bool extinction = quantity->quantity == volume::Quantity::kExtinction;
  const std::string plain = PlainUnits(units);
  if (plain.empty()) {
    // Without units, extinction is assumed to be in 1/m. The unit of an amount of water stays
    // unknown, because it may be per kg or per m3.
    quantity->known_units = extinction;
    return;
  }
  const auto at = std::ranges::find(kScales, std::string_view(plain), &Scale::units);
  quantity->known_units =
      at != kScales.end() && (at->quantity == volume::Quantity::kExtinction) == extinction;
  if (!quantity->known_units) return;
  quantity->quantity = at->quantity;
  quantity->scale = at->scale;
}

std::optional<AirVariable> AirByName(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  const std::string name = absl::AsciiStrToLower(variable.name);
  const bool plain = standard.empty();
  if (standard == "air_density" || (plain && IsOneOf(name, {"rho", "air_density", "rhoa"}))) {
    return AirVariable::kDensity;
  }
  if (standard == "air_pressure" || (plain && IsOneOf(name, {"p", "prs", "pres", "pressure"}))) {
    return AirVariable::kPressure;
  }
  if (standard == "air_temperature" || (plain && IsOneOf(name, {"t", "ta", "temp"}))) {
    return AirVariable::kTemperature;
  }
  if (standard == "air_potential_temperature" || (plain && IsOneOf(name, {"th", "theta"}))) {
    return AirVariable::kPotentialTemperature;
  }
  if (IsOneOf(standard, {"specific_humidity", "humidity_mixing_ratio"}) ||
      (plain && IsOneOf(name, {"qv", "qvapor"}))) {
    return AirVariable::kVapour;
  }
  return std::nullopt;
}

std::optional<WindVariable> WindByName(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  const std::string name = absl::AsciiStrToLower(variable.name);
  const bool plain = standard.empty();
  if (IsOneOf(standard, {"eastward_wind", "x_wind", "grid_eastward_wind"}) ||
      (plain && IsOneOf(name, {"u", "ua", "uinterp", "u_wind"}))) {
    return WindVariable::kEastward;
  }
  if (IsOneOf(standard, {"northward_wind", "y_wind", "grid_northward_wind"}) ||
      (plain && IsOneOf(name, {"v", "va", "vinterp", "v_wind"}))) {
    return WindVariable::kNorthward;
  }
  if (standard == "upward_air_velocity" ||
      (plain && IsOneOf(name, {"w", "wa", "winterp", "w_wind"}))) {
    return WindVariable::kUpward;
  }
  if (standard == "specific_turbulent_kinetic_energy_of_air" ||
      (plain && IsOneOf(name, {"tke", "tke_pbl"}))) {
    return WindVariable::kTurbulentEnergy;
  }
  return std::nullopt;
}

bool IsEastwards(std::string_view plain_units) {
  return IsOneOf(plain_units, {"degreeseast", "degreeeast", "degreee", "degreese"});
}

bool IsNorthwards(std::string_view plain_units) {
  return IsOneOf(plain_units, {"degreesnorth", "degreenorth", "degreen", "degreesn"});
}

}  // namespace

std::string PlainUnits(std::string_view units) {
  std::string plain = absl::AsciiStrToLower(absl::string_view(units.data(), units.size()));
  if (units.starts_with("Mg")) plain[0] = 'M';
  std::erase_if(plain, [](char c) { return c == ' ' || c == '*' || c == '^' || c == '.'; });
  std::erase_if(plain, [](char c) { return c == '(' || c == ')' || c == '_'; });
  return plain;
}

std::optional<CfQuantity> QuantityOf(const CfDescription& variable) {
  std::optional<CfQuantity> quantity;
  const std::string name = absl::AsciiStrToLower(variable.name);
  if (name == "extinction" ||
      absl::StartsWith(variable.standard_name, "volume_extinction_coefficient_in_air")) {
    quantity.emplace();
    quantity->quantity = volume::Quantity::kExtinction;
  } else if (!variable.standard_name.empty()) {
    quantity = FromStandardName(variable.standard_name);
  } else if (const auto hydrometeor = Find(kVariables, name); hydrometeor.has_value()) {
    quantity.emplace();
    quantity->hydrometeor = *hydrometeor;
  }
  if (quantity.has_value()) ApplyUnits(variable.units, &*quantity);
  return quantity;
}

std::optional<CfAir> AirVariableOf(const CfDescription& variable) {
  const std::optional<AirVariable> kind = AirByName(variable);
  if (!kind.has_value()) return std::nullopt;
  CfAir air;
  air.variable = *kind;
  air.of_moist_air = variable.standard_name == "specific_humidity";
  const std::string units = PlainUnits(variable.units);
  switch (*kind) {
    case AirVariable::kDensity:
      air.known_units = IsOneOf(units, {"", "kgm-3", "kg/m3"});
      break;
    case AirVariable::kPressure:
      if (IsOneOf(units, {"hpa", "mbar", "millibar", "mb"})) air.scale = 100.0;
      air.known_units = air.scale != 1.0 || IsOneOf(units, {"", "pa", "pascal", "nm-2"});
      break;
    case AirVariable::kTemperature:
    case AirVariable::kPotentialTemperature:
      if (IsOneOf(units, {"degc", "celsius", "degreescelsius", "c"})) air.offset = 273.15;
      air.known_units = air.offset != 0.0 || IsOneOf(units, {"", "k", "kelvin", "degk"});
      break;
    case AirVariable::kVapour:
      if (IsOneOf(units, {"gkg-1", "g/kg"})) air.scale = 1e-3;
      air.known_units = air.scale != 1.0 || IsOneOf(units, {"", "1", "kgkg-1", "kg/kg"});
      break;
  }
  return air;
}

std::optional<CfWind> WindVariableOf(const CfDescription& variable) {
  const std::optional<WindVariable> kind = WindByName(variable);
  if (!kind.has_value()) return std::nullopt;
  const std::string units = PlainUnits(variable.units);
  const bool known = *kind == WindVariable::kTurbulentEnergy
                         ? IsOneOf(units, {"m2s-2", "m2/s2", "jkg-1", "j/kg"})
                         : IsOneOf(units, {"ms-1", "m/s", "meterspersecond", "metrespersecond"});
  return CfWind{*kind, known};
}

std::optional<CfDirection> DirectionOf(const CfDescription& coordinate) {
  const std::string axis = absl::AsciiStrToUpper(coordinate.axis);
  if (axis == "X") return CfDirection::kX;
  if (axis == "Y") return CfDirection::kY;
  if (axis == "Z") return CfDirection::kZ;
  if (axis == "T") return CfDirection::kTime;
  const std::string& standard = coordinate.standard_name;
  if (IsOneOf(standard, {"projection_x_coordinate", "longitude", "grid_longitude"})) {
    return CfDirection::kX;
  }
  if (IsOneOf(standard, {"projection_y_coordinate", "latitude", "grid_latitude"})) {
    return CfDirection::kY;
  }
  if (IsOneOf(standard, {"height", "altitude", "depth", "height_above_mean_sea_level",
                         "height_above_reference_ellipsoid"})) {
    return CfDirection::kZ;
  }
  if (standard == "time" || absl::StrContains(coordinate.units, " since ")) {
    return CfDirection::kTime;
  }
  const std::string units = PlainUnits(coordinate.units);
  if (IsEastwards(units)) return CfDirection::kX;
  if (IsNorthwards(units)) return CfDirection::kY;
  if (!coordinate.positive.empty()) return CfDirection::kZ;
  const std::string name = absl::AsciiStrToLower(coordinate.name);
  if (IsOneOf(name, {"x", "xh", "xc", "lon", "longitude", "easting", "nx", "west_east"})) {
    return CfDirection::kX;
  }
  if (IsOneOf(name, {"y", "yh", "yc", "lat", "latitude", "northing", "ny", "south_north"})) {
    return CfDirection::kY;
  }
  if (IsOneOf(name, {"z", "zh", "zc", "height", "altitude", "alt", "lev", "level", "nz"})) {
    return CfDirection::kZ;
  }
  if (IsOneOf(name, {"t", "time"})) return CfDirection::kTime;
  return std::nullopt;
}

std::optional<double> MetresIn(std::string_view units) {
  const std::string plain = PlainUnits(units);
  if (IsOneOf(plain, {"", "m", "meter", "meters", "metre", "metres"})) return 1.0;
  if (IsOneOf(plain, {"km", "kilometer", "kilometers", "kilometre", "kilometres"})) return 1000.0;
  return std::nullopt;
}

bool IsDegrees(std::string_view units, CfDirection direction) {
  const std::string plain = PlainUnits(units);
  if (direction == CfDirection::kX && IsEastwards(plain)) return true;
  if (direction == CfDirection::kY && IsNorthwards(plain)) return true;
  const bool horizontal = direction == CfDirection::kX || direction == CfDirection::kY;
  return horizontal && IsOneOf(plain, {"degree", "degrees"});
}

}  // namespace thunderhead::storm_files
