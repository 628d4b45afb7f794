#include "storm_files/cf_names.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/strip.h"
#include "storm_files/date_time.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

struct Named {
  std::string_view name;
  Hydrometeor hydrometeor;
  std::string_view long_name = {};  // if not empty, the long_name must contain it, in small letters
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
    Named{"qc", Hydrometeor::kCloud},
    Named{"qcloud", Hydrometeor::kCloud},
    Named{"ql", Hydrometeor::kCloud},
    Named{"clw", Hydrometeor::kCloud},
    Named{"lwc", Hydrometeor::kCloud},
    Named{"qr", Hydrometeor::kRain},
    Named{"qrain", Hydrometeor::kRain},
    Named{"rwc", Hydrometeor::kRain},
    Named{"qi", Hydrometeor::kIce},
    Named{"qice", Hydrometeor::kIce},
    Named{"cli", Hydrometeor::kIce},
    Named{"iwc", Hydrometeor::kIce},
    Named{"qs", Hydrometeor::kSnow},
    Named{"qsnow", Hydrometeor::kSnow},
    Named{"swc", Hydrometeor::kSnow},
    Named{"qg", Hydrometeor::kGraupel},
    Named{"qgraup", Hydrometeor::kGraupel},
    Named{"qgraupel", Hydrometeor::kGraupel},
    Named{"qh", Hydrometeor::kHail},
    Named{"qhail", Hydrometeor::kHail},
    Named{"qhl", Hydrometeor::kHail},
    Named{"clwc", Hydrometeor::kCloud},
    Named{"ciwc", Hydrometeor::kIce},
    Named{"crwc", Hydrometeor::kRain},
    Named{"cswc", Hydrometeor::kSnow},
    Named{"clwmr", Hydrometeor::kCloud},
    Named{"q_liquid", Hydrometeor::kCloud},
    Named{"q_ice", Hydrometeor::kIce},
    // CAM
    Named{"cldliq", Hydrometeor::kCloud},
    Named{"cldice", Hydrometeor::kIce},
    Named{"rainqm", Hydrometeor::kRain},
    Named{"snowqm", Hydrometeor::kSnow},
    Named{"grauqm", Hydrometeor::kGraupel},
    // DALES
    Named{"plw", Hydrometeor::kRain, "precipitating liquid"},
    Named{"pli", Hydrometeor::kSnow, "precipitating ice"},
    // Meso-NH
    Named{"rct", Hydrometeor::kCloud},
    Named{"rrt", Hydrometeor::kRain},
    Named{"rit", Hydrometeor::kIce},
    Named{"rst", Hydrometeor::kSnow},
    Named{"rgt", Hydrometeor::kGraupel},
    Named{"rht", Hydrometeor::kHail},
    // MONC
    Named{"q_cloud_liquid_mass", Hydrometeor::kCloud},
    Named{"q_rain_mass", Hydrometeor::kRain},
    Named{"q_ice_mass", Hydrometeor::kIce},
    Named{"q_cloud_ice_mass", Hydrometeor::kIce},
    Named{"q_snow_mass", Hydrometeor::kSnow},
    Named{"q_graupel_mass", Hydrometeor::kGraupel},
    // UCLA-LES, whose names are so short that the long_name must match, too
    Named{"l", Hydrometeor::kCloud, "liquid water mixing ratio"},
    Named{"r", Hydrometeor::kRain, "rain-water mixing ratio"},
    Named{"rice", Hydrometeor::kIce, "ice mixing ratio"},
    Named{"rsnow", Hydrometeor::kSnow, "snow mixing ratio"},
    Named{"rgrp", Hydrometeor::kGraupel, "graupel mixing ratio"},
    Named{"rhail", Hydrometeor::kHail, "hail mixing ratio"},
};

// Variables of SAM that hold several hydrometeors.
struct NamedMixture {
  std::string_view name;
  std::string_view long_name;  // in small letters
  MixedWater mixed;
};
constexpr std::array kMixtures = {
    NamedMixture{"qn", "non-precipitating condensate", MixedWater::kCloud},
    NamedMixture{"qp", "precipitating water", MixedWater::kPrecipitation},
};

// Substances like kSubstances that are several hydrometeors.
constexpr std::array kMixedSubstances = {
    NamedMixture{"cloud_condensed_water", "", MixedWater::kCloud},
    NamedMixture{"stratiform_cloud_condensed_water", "", MixedWater::kCloud},
    NamedMixture{"precipitation", "", MixedWater::kPrecipitation},
};

template <std::size_t count>
std::optional<Hydrometeor> Find(const std::array<Named, count>& table, std::string_view name) {
  const auto at = std::ranges::find(table, name, &Named::name);
  return at == table.end() ? std::nullopt : std::optional(at->hydrometeor);
}

bool Says(const std::string& lower_long_name, std::string_view phrase) {
  return absl::StrContains(lower_long_name, absl::string_view(phrase.data(), phrase.size()));
}

bool IsOneOf(std::string_view text, std::initializer_list<std::string_view> list) {
  return std::ranges::find(list, text) != list.end();
}

// Returns the quantity for which a standard name of an amount of water stands. It is a
// concentration, a fraction of moist air or a ratio to dry air.
std::optional<CfQuantity> FromStandardName(const std::string& standard_name) {
  absl::string_view substance = standard_name;
  CfQuantity quantity;
  quantity.of_air_by = "standard name";
  if (absl::ConsumePrefix(&substance, "mass_fraction_of_")) {
    quantity.of_moist_air = true;
    absl::ConsumeSuffix(&substance, "_in_air");
  } else if (absl::ConsumePrefix(&substance, "mass_concentration_of_")) {
    quantity.quantity = volume::Quantity::kMassConcentration;
    absl::ConsumeSuffix(&substance, "_in_air");
  } else if (absl::ConsumePrefix(&substance, "specific_") &&
             absl::ConsumeSuffix(&substance, "_content")) {
    quantity.of_moist_air = true;
  } else if (!absl::ConsumeSuffix(&substance, "_mixing_ratio")) {
    return std::nullopt;
  }
  const std::string_view name(substance.data(), substance.size());
  if (const auto hydrometeor = Find(kSubstances, name); hydrometeor.has_value()) {
    quantity.hydrometeor = *hydrometeor;
    return quantity;
  }
  const auto mixture = std::ranges::find(kMixedSubstances, name, &NamedMixture::name);
  if (mixture == kMixedSubstances.end()) return std::nullopt;
  quantity.mixed = mixture->mixed;
  quantity.liquid_next_to_ice = mixture->mixed == MixedWater::kCloud;
  return quantity;
}

// Returns the quantity of a variable whose standard name is not that of an amount of water.
std::optional<CfQuantity> FromName(const CfDescription& variable) {
  const std::string name = absl::AsciiStrToLower(variable.name);
  const std::string long_name = absl::AsciiStrToLower(variable.long_name);
  CfQuantity quantity;
  // DALES and ECMWF write specific contents, and say so here.
  const bool is_specific = Says(long_name, "mass fraction") || Says(long_name, "specific");
  quantity.of_moist_air = is_specific || IsCamName(variable.name);
  if (is_specific) quantity.of_air_by = "long name";
  for (const Named& each : kVariables) {
    if (each.name != name || !Says(long_name, each.long_name)) continue;
    quantity.hydrometeor = each.hydrometeor;
    return quantity;
  }
  for (const NamedMixture& each : kMixtures) {
    if (each.name != name || !Says(long_name, each.long_name)) continue;
    quantity.mixed = each.mixed;
    return quantity;
  }
  // Some programs use the standard name as the name, and write no attribute.
  std::optional<CfQuantity> by_standard_name = FromStandardName(name);
  if (by_standard_name.has_value()) by_standard_name->of_air_by = "name";
  return by_standard_name;
}

// Returns whether a variable holds something else than its name says: the liquid water potential
// temperature, which UCLA-LES calls t, or a deviation from a base state.
bool IsOtherThanNamed(const CfDescription& variable) {
  const std::string long_name = absl::AsciiStrToLower(variable.long_name);
  for (const char* phrase : {"liquid", "virtual", "equivalent", "perturbation", "deviation",
                             "anomaly", "tendency", "total water"}) {
    if (Says(long_name, phrase)) return true;
  }
  return false;
}

// Returns whether a unit without a dimension may be that of a mass ratio. Shares such as "%" and
// "ppm" are usually shares of volume or of an area. A plain number is a mass ratio by convention.
bool MayBeMassRatio(const std::string& units) {
  return absl::StrContains(absl::AsciiStrToLower(units), "g") ||
         std::ranges::none_of(units, [](char c) { return absl::ascii_isalpha(c) || c == '%'; });
}

void ApplyUnits(const std::string& units, CfQuantity* quantity) {
  const bool extinction = quantity->quantity == volume::Quantity::kExtinction;
  quantity->known_units = true;
  if (HasNoUnits(units)) {
    // Without units, extinction is assumed to be in 1/m. The unit of an amount of water stays
    // unknown, because it may be per kg or per m3.
    quantity->known_units = extinction;
    return;
  }
  const auto use = [&](std::string_view unit, volume::Quantity as) {
    const std::optional<UnitConversion> conversion = ConversionOf(units, unit);
    // A negative unit ("-1 kg m-3") would make amounts negative.
    if (!conversion.has_value() || conversion->offset != 0.0 || conversion->scale < 0.0) {
      return false;
    }
    quantity->quantity = as;
    quantity->scale = conversion->scale;
    return true;
  };
  if (extinction) {
    quantity->known_units = use("m-1", volume::Quantity::kExtinction);
  } else if (!use("kg m-3", volume::Quantity::kMassConcentration)) {
    quantity->known_units = MayBeMassRatio(units) && use("1", volume::Quantity::kMixingRatio);
  }
}

// Returns whether only the variable's name says what it holds. ICON repeats some names in the
// attribute standard_name, and cfgrib writes "unknown" there.
bool HasPlainName(const CfDescription& variable) {
  return variable.standard_name.empty() || variable.standard_name == "unknown" ||
         absl::EqualsIgnoreCase(variable.standard_name, variable.name);
}

std::optional<AirVariable> AirByName(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  const std::string name = absl::AsciiStrToLower(variable.name);
  if (standard == "difference_of_air_pressure_from_model_reference" ||
      (standard.empty() && IsOneOf(name, {"pp", "prspert"}))) {
    return AirVariable::kPressureDeviation;
  }
  const bool plain = HasPlainName(variable) && !IsOtherThanNamed(variable);
  if (standard == "air_density" ||
      (plain && IsOneOf(name, {"rho", "air_density", "rhoa", "rhobf", "rhof", "rhoref", "rhob",
                               "rhon", "dn0"}))) {
    return AirVariable::kDensity;
  }
  if (standard == "air_pressure" ||
      (plain && IsOneOf(name, {"p", "prs", "pres", "pressure", "pabst", "air_pressure"}))) {
    return AirVariable::kPressure;
  }
  if (standard == "air_temperature" ||
      (plain && IsOneOf(name, {"t", "ta", "temp", "tabs", "air_temperature"}))) {
    return AirVariable::kTemperature;
  }
  if (standard == "air_potential_temperature" ||
      (plain && IsOneOf(name, {"th", "theta", "tht", "air_potential_temperature"}))) {
    return AirVariable::kPotentialTemperature;
  }
  if (IsOneOf(standard, {"specific_humidity", "humidity_mixing_ratio"}) ||
      (plain && IsOneOf(name, {"qv", "qvapor", "q", "hus", "rvt", "q_vapour", "specific_humidity",
                               "humidity_mixing_ratio"}))) {
    return AirVariable::kVapour;
  }
  return std::nullopt;
}

std::optional<WindVariable> WindByName(const CfDescription& variable) {
  const std::string& standard = variable.standard_name;
  const std::string name = absl::AsciiStrToLower(variable.name);
  const bool plain = HasPlainName(variable);
  if (IsOneOf(standard, {"eastward_wind", "x_wind", "grid_eastward_wind"}) ||
      (plain && IsOneOf(name, {"u", "ua", "uinterp", "u_wind", "ureconstructzonal"}))) {
    return WindVariable::kEastward;
  }
  if (IsOneOf(standard, {"northward_wind", "y_wind", "grid_northward_wind"}) ||
      (plain && IsOneOf(name, {"v", "va", "vinterp", "v_wind", "ureconstructmeridional"}))) {
    return WindVariable::kNorthward;
  }
  if (standard == "upward_air_velocity" ||
      (plain && IsOneOf(name, {"w", "wa", "winterp", "w_wind"}))) {
    return WindVariable::kUpward;
  }
  if (IsOneOf(standard, {"specific_turbulent_kinetic_energy_of_air", "turbulent_kinetic_energy"}) ||
      (plain && IsOneOf(name, {"tke", "tke_pbl"}))) {
    return WindVariable::kTurbulentEnergy;
  }
  return std::nullopt;
}

// Returns whether the units are one of the spellings of CF for degrees of longitude or latitude.
bool IsEastwards(std::string_view units) {
  return IsOneOf(absl::AsciiStrToLower(absl::string_view(units.data(), units.size())),
                 {"degrees_east", "degree_east", "degree_e", "degrees_e", "degreee", "degreese"});
}

bool IsNorthwards(std::string_view units) {
  return IsOneOf(absl::AsciiStrToLower(absl::string_view(units.data(), units.size())),
                 {"degrees_north", "degree_north", "degree_n", "degrees_n", "degreen", "degreesn"});
}

}  // namespace

bool IsCamName(std::string_view variable) {
  return IsOneOf(variable, {"CLDLIQ", "CLDICE", "RAINQM", "SNOWQM", "GRAUQM"});
}

bool HasNoUnits(std::string_view units) {
  return absl::StripAsciiWhitespace(absl::string_view(units.data(), units.size())).empty();
}

std::optional<CfQuantity> QuantityOf(const CfDescription& variable) {
  std::optional<CfQuantity> quantity;
  const std::string name = absl::AsciiStrToLower(variable.name);
  if (name == "extinction" ||
      absl::StartsWith(variable.standard_name, "volume_extinction_coefficient_in_air")) {
    quantity.emplace();
    quantity->quantity = volume::Quantity::kExtinction;
  } else {
    // A standard name may also be the name, so the standard name is compared first.
    quantity = FromStandardName(variable.standard_name);
    if (!quantity.has_value() && HasPlainName(variable)) quantity = FromName(variable);
  }
  if (quantity.has_value()) ApplyUnits(variable.units, &*quantity);
  return quantity;
}

std::optional<CfAir> AirVariableOf(const CfDescription& variable) {
  const std::optional<AirVariable> kind = AirByName(variable);
  if (!kind.has_value()) return std::nullopt;
  CfAir air;
  air.variable = *kind;
  air.of_moist_air = variable.standard_name == "specific_humidity" ||
                     (HasPlainName(variable) && IsOneOf(absl::AsciiStrToLower(variable.name),
                                                        {"q", "hus", "qv_s", "specific_humidity"}));
  const auto use = [&](std::string_view unit) {
    if (HasNoUnits(variable.units)) return true;
    const std::optional<UnitConversion> conversion = ConversionOf(variable.units, unit);
    if (!conversion.has_value() || conversion->scale < 0.0) return false;
    air.scale = conversion->scale;
    air.offset = conversion->offset;
    return true;
  };
  switch (*kind) {
    case AirVariable::kDensity:
      air.known_units = use("kg m-3");
      break;
    case AirVariable::kPressure:
    case AirVariable::kPressureDeviation:
      air.known_units = use("Pa");
      break;
    case AirVariable::kTemperature:
    case AirVariable::kPotentialTemperature:
      air.known_units = use("K");
      break;
    case AirVariable::kVapour:
      air.known_units = use("1") && (HasNoUnits(variable.units) || MayBeMassRatio(variable.units));
      break;
  }
  return air;
}

std::optional<CfWind> WindVariableOf(const CfDescription& variable) {
  const std::optional<WindVariable> kind = WindByName(variable);
  if (!kind.has_value()) return std::nullopt;
  const bool energy = *kind == WindVariable::kTurbulentEnergy;
  const std::optional<UnitConversion> conversion =
      ConversionOf(variable.units, energy ? "m2 s-2" : "m s-1");
  const bool known = conversion.has_value() && conversion->offset == 0.0;
  const bool true_east = IsOneOf(variable.standard_name, {"eastward_wind", "northward_wind"}) ||
                         absl::StartsWith(variable.name, "uReconstruct");
  return CfWind{*kind, known, known ? conversion->scale : 1.0, true_east};
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
  if (absl::StartsWith(standard, "atmosphere_") || absl::StrContains(standard, "model_level") ||
      standard == "air_pressure") {
    return CfDirection::kZ;
  }
  if (IsOneOf(standard, {"time", "forecast_period"}) ||
      absl::StrContains(WithSince(coordinate.units), " since ")) {
    return CfDirection::kTime;
  }
  if (IsEastwards(coordinate.units)) return CfDirection::kX;
  if (IsNorthwards(coordinate.units)) return CfDirection::kY;
  if (!coordinate.positive.empty()) return CfDirection::kZ;
  const std::string name = absl::AsciiStrToLower(coordinate.name);
  if (IsOneOf(name, {"x", "xh", "xc", "xf", "xt", "xm", "xu", "lon", "longitude", "rlon", "easting",
                     "nx", "ni", "nip1", "west_east"})) {
    return CfDirection::kX;
  }
  if (IsOneOf(name, {"y", "yh", "yc", "yf", "yt", "ym", "yv", "lat", "latitude", "rlat", "northing",
                     "ny", "nj", "njp1", "south_north"})) {
    return CfDirection::kY;
  }
  if (IsOneOf(name, {"z",          "zh",     "zc",          "zf",           "zt",    "zm",
                     "zn",         "zw",     "height",      "altitude",     "alt",   "lev",
                     "level",      "nz",     "nk",          "nkp1",         "zu_3d", "zw_3d",
                     "bottom_top", "hybrid", "nvertlevels", "nvertlevelsp1"})) {
    return CfDirection::kZ;
  }
  // CDO appends numbers to equal names, as in "height_2". ICON and COSMO call their levels so.
  for (const char* prefix : {"height_", "lev_", "level", "generalvertical", "plev", "z_"}) {
    if (absl::StartsWith(name, prefix)) return CfDirection::kZ;
  }
  if (IsOneOf(name, {"t", "time"}) || absl::StartsWith(name, "time_series")) {
    return CfDirection::kTime;
  }
  return std::nullopt;
}

std::optional<double> MetresIn(std::string_view units) {
  if (HasNoUnits(units)) return 1.0;
  const std::optional<UnitConversion> conversion = ConversionOf(units, "m");
  if (!conversion.has_value() || conversion->offset != 0.0) return std::nullopt;
  return conversion->scale;
}

std::optional<double> DegreesIn(std::string_view units, CfDirection direction) {
  if (direction != CfDirection::kX && direction != CfDirection::kY) return std::nullopt;
  if (IsEastwards(units)) return direction == CfDirection::kX ? std::optional(1.0) : std::nullopt;
  if (IsNorthwards(units)) return direction == CfDirection::kY ? std::optional(1.0) : std::nullopt;
  const std::optional<UnitConversion> conversion = ConversionOf(units, "degree");
  if (!conversion.has_value() || conversion->offset != 0.0) return std::nullopt;
  // UDUNITS treats "degrees_west" as plain degrees, without the opposite sign, so such units are
  // refused.
  return units.find('_') != std::string_view::npos || units.find("true") != std::string_view::npos
             ? std::nullopt
             : std::optional(conversion->scale);
}

}  // namespace thunderhead::storm_files
