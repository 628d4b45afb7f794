// Recognises which quantity a CF variable holds, by its standard name, name and units, and which
// direction a dimension has. These functions only compare names and do not read files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "storm_files/mixed_water.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// A variable's attributes. Missing attributes are empty.
struct CfDescription {
  std::string name;
  std::string standard_name;
  std::string units;
  std::string axis;
  std::string positive;
  std::string long_name;
};

// Returns whether a `units` attribute is absent or blank.
bool HasNoUnits(std::string_view units);

// The quantity of a variable that can be drawn. The variable's values times `scale` are in the
// quantity's unit.
struct CfQuantity {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  volume::Quantity quantity = volume::Quantity::kMixingRatio;
  double scale = 1.0;
  bool of_moist_air = false;  // true for a mixing ratio per mass of moist air instead of dry air
  // The attribute that says of which air the mixing ratio is, for users; empty if none says so.
  std::string_view of_air_by;
  bool known_units = true;  // false if the name is recognised but the units cannot be converted
  MixedWater mixed = MixedWater::kNone;  // the hydrometeors that share the variable
  // True for condensed cloud water, which models also call the liquid alone. It is cloud water if
  // the file has cloud ice, too.
  bool liquid_next_to_ice = false;
};

// Returns whether CAM, the atmosphere of CESM, gives this name to a hydrometeor.
bool IsCamName(std::string_view variable);

// Returns nothing if the variable is neither a hydrometeor nor extinction.
std::optional<CfQuantity> QuantityOf(const CfDescription& variable);

// Variables of the state of the air. A deviation of pressure is that from a reference atmosphere.
enum class AirVariable {
  kDensity,
  kPressure,
  kPressureDeviation,
  kTemperature,
  kPotentialTemperature,
  kVapour
};

struct CfAir {
  AirVariable variable = AirVariable::kDensity;
  double scale = 1.0;
  double offset = 0.0;
  bool of_moist_air = false;  // true if vapour is given as specific humidity
  bool known_units = true;
};

std::optional<CfAir> AirVariableOf(const CfDescription& variable);

// Variables of the motion of the air.
enum class WindVariable { kEastward, kNorthward, kUpward, kTurbulentEnergy };

struct CfWind {
  WindVariable variable = WindVariable::kEastward;
  bool known_units = true;  // false if the units do not fit: speed, or speed squared for energy
  double scale = 1.0;       // factor from the variable's unit to m s-1 or m2 s-2
  bool true_east = false;  // true if the component is to the true east or north, not along the grid
};

std::optional<CfWind> WindVariableOf(const CfDescription& variable);

enum class CfDirection { kX, kY, kZ, kTime };

// Returns the direction of a coordinate, from its axis attribute, standard name, units, `positive`
// or name.
std::optional<CfDirection> DirectionOf(const CfDescription& coordinate);

// Returns the length in metres of one unit, or nothing if `units` is not a unit of length. An empty
// text means metres.
std::optional<double> MetresIn(std::string_view units);

// Returns the angle in degrees of one unit along x (of longitude) or y (of latitude). The unit may
// lack a direction, like that of a rotated grid. Returns nothing for other units and directions.
std::optional<double> DegreesIn(std::string_view units, CfDirection direction);

}  // namespace thunderhead::storm_files
