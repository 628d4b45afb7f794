// The meaning of the fields of GRIB files for a storm. Fields are identified by the numbers of
// discipline, category and parameter (code table 4.2), never by names, because names differ between
// programs.
#pragma once

#include <string>

#include "grib/index.h"
#include "physics/hydrometeors.h"
#include "storm_files/layer_source.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

enum class GribKind {
  kNone,
  kAmount,              // of a hydrometeor
  kNumber,              // of a hydrometeor's particles, per kg of air
  kGeopotentialHeight,  // in m
  kGeometricHeight,     // in m above sea level
  kGeopotential,        // in m2/s2
  kPressure,            // in Pa
  kLogPressure,         // natural logarithm of the surface pressure in Pa
  kTemperature,         // in K
  kSpecificHumidity,    // kg per kg of moist air
  kVapourRatio,         // kg per kg of dry air
  kRelativeHumidity,    // in percent
  kWindX,               // m/s, east or along x
  kWindY,               // m/s, north or along y
  kAscent,              // m/s, geometric
  kOmega,               // Pa/s
  kTurbulentEnergy,     // m2/s2
  kCellLatitude,        // in degrees, of each cell of an unstructured grid
  kCellLongitude,
  kLandShare,   // 0 to 1; the rest is water
  kLandUse,     // class of MODIS (IGBP), counted from 1; a number of NCEP's own table
  kSnowCover,   // in percent
  kAlbedo,      // in percent
  kGreenCover,  // in percent
};

// Returns whether the kind describes the ground's colour, which a storm does not need.
constexpr bool IsOfLand(GribKind kind) { return kind >= GribKind::kLandShare; }

struct GribMeaning {
  GribKind kind = GribKind::kNone;
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;  // for amounts and numbers
  volume::Quantity quantity = volume::Quantity::kMixingRatio;       // for amounts
  bool is_specific = false;  // for amounts: true if the parameter is per kg of whole air
};

GribMeaning MeaningOf(const grib::Parameter& parameter);

// Returns a parameter's name: NCEP's at NCEP, e.g. "CLMR", and DWD's at centres that use its
// models, e.g. "QC". At other centres it is ECMWF's name or, if there is none, NCEP's. Returns the
// numbers of an unknown parameter, e.g. "0/1/22".
std::string GribNameOf(const grib::Parameter& parameter, int centre);

// Returns the name of a kind in a sentence: "temperature (0/0/0)".
std::string GribKindName(GribKind kind);

// The model that wrote a file, as far as its centre and the number of its process tell.
struct GribModel {
  std::string name;           // "NCEP HRRR"
  AirMass mixing_ratios_per;  // the air of which the model's mixing ratios are a share
  std::string why;            // "the WRF model, which HRRR uses, has mixing ratios of dry air"
  physics::Microphysics microphysics = physics::Microphysics::kUnknown;
  bool splits_cloud = false;  // true if cloud water without cloud ice holds both
};

GribModel ModelOf(const grib::Field& field);

// Returns whether a field of kLandUse has the classes of MODIS (IGBP), because its centre's table
// says so.
bool HasModisClasses(const grib::Field& field);

}  // namespace thunderhead::storm_files
