// Which quantity a variable of a CF file is, from its standard name, its name and its units, and
// which way a dimension runs. Pure look-up: knows no files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// What a file says of one variable; parts that it does not say are empty.
struct CfDescription {
  std::string name;
  std::string standard_name;
  std::string units;
  std::string axis;
  std::string positive;
};

// Units without blanks, stars, hats, dots and brackets, in lower case: "kg m**-3" is "kgm-3".
std::string PlainUnits(std::string_view units);

// A variable that can be drawn. `scale` takes its values to the quantity's unit.
struct CfQuantity {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  Quantity quantity = Quantity::kMixingRatio;
  double scale = 1.0;
  bool of_moist_air = false;  // a mixing ratio that refers to moist, not dry air
  bool known_units = true;    // false: it is drawable by name, but its units cannot be used
};

// Nothing if the variable is no hydrometeor and no extinction.
std::optional<CfQuantity> QuantityOf(const CfDescription& variable);

// What describes the air in a cell.
enum class AirVariable { kDensity, kPressure, kTemperature, kPotentialTemperature, kVapour };

struct CfAir {
  AirVariable variable = AirVariable::kDensity;
  double scale = 1.0;
  double offset = 0.0;
  bool of_moist_air = false;  // vapour as specific humidity
  bool known_units = true;
};

std::optional<CfAir> AirVariableOf(const CfDescription& variable);

enum class CfDirection { kX, kY, kZ, kTime };

// Which way a coordinate runs, from its axis attribute, standard name, units, `positive` or name.
std::optional<CfDirection> DirectionOf(const CfDescription& coordinate);

// Metres in one of the unit; nothing if it is no length. An empty unit means metres.
std::optional<double> MetresIn(std::string_view units);

// Degrees of latitude or longitude.
bool IsDegrees(std::string_view units);

}  // namespace thunderhead::volume
