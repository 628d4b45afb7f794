// Recognises the quantity of a CF variable by its standard name, name and units, and the direction
// of a dimension. These functions only look up names and do not depend on files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// A variable's attributes. Missing attributes are empty.
struct CfDescription {
  std::string name;
  std::string standard_name;
  std::string units;
  std::string axis;
  std::string positive;
};

// Returns units in lower case without blanks, stars, carets, dots, brackets and underscores: "kg
// m**-3" becomes "kgm-3". "Mg" keeps its capital, because one "Mg" is a thousand million "mg".
std::string PlainUnits(std::string_view units);

// A variable that can be drawn. Values times `scale` are in the quantity's unit.
struct CfQuantity {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  volume::Quantity quantity = volume::Quantity::kMixingRatio;
  double scale = 1.0;
  bool of_moist_air = false;  // a mixing ratio that refers to moist, not dry air
  bool known_units = true;    // false: recognised by name, but in units that cannot be converted
};

// Returns nothing if the variable is neither a hydrometeor nor extinction.
std::optional<CfQuantity> QuantityOf(const CfDescription& variable);

// Variables of the state of the air.
enum class AirVariable { kDensity, kPressure, kTemperature, kPotentialTemperature, kVapour };

struct CfAir {
  AirVariable variable = AirVariable::kDensity;
  double scale = 1.0;
  double offset = 0.0;
  bool of_moist_air = false;  // vapour as specific humidity
  bool known_units = true;
};

std::optional<CfAir> AirVariableOf(const CfDescription& variable);

// Variables of the motion of the air.
enum class WindVariable { kEastward, kNorthward, kUpward, kTurbulentEnergy };

struct CfWind {
  WindVariable variable = WindVariable::kEastward;
  bool known_units = true;  // false: not in m s-1 or m2 s-2
};

std::optional<CfWind> WindVariableOf(const CfDescription& variable);

enum class CfDirection { kX, kY, kZ, kTime };

// Returns the direction of a coordinate, from its axis attribute, standard name, units, `positive`
// or name.
std::optional<CfDirection> DirectionOf(const CfDescription& coordinate);

// Returns the unit in metres, or nothing if it is not a length. An empty unit means metres.
std::optional<double> MetresIn(std::string_view units);

// Returns whether the units are degrees along x (of longitude) or y (of latitude), or degrees
// without a direction, such as those of a rotated grid.
bool IsDegrees(std::string_view units, CfDirection direction);

}  // namespace thunderhead::storm_files
