#include "storm_files/grib_parameters.h"

#include <algorithm>
#include <array>
#include <optional>

#include "absl/strings/str_cat.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using volume::Quantity;

struct Row {
  grib::Parameter parameter;
  GribMeaning meaning;
  const char* ncep;   // the name at NCEP
  const char* dwd;    // the name at DWD, or null
  const char* ecmwf;  // the name at ECMWF, or null
};

constexpr GribMeaning Ratio(Hydrometeor hydrometeor) {
  return {GribKind::kAmount, hydrometeor, Quantity::kMixingRatio, false};
}
constexpr GribMeaning Specific(Hydrometeor hydrometeor) {
  return {GribKind::kAmount, hydrometeor, Quantity::kMixingRatio, true};
}
constexpr GribMeaning Density(Hydrometeor hydrometeor) {
  return {GribKind::kAmount, hydrometeor, Quantity::kMassConcentration, false};
}
constexpr GribMeaning Number(Hydrometeor hydrometeor) {
  return {.kind = GribKind::kNumber, .hydrometeor = hydrometeor};
}
constexpr GribMeaning Only(GribKind kind) { return {.kind = kind}; }

// Sources: WMO code table 4.2, version 30, and for the names NCEP's GRIB2 tables, DWD's and ECMWF's
// parameter databases. If a file has several parameters of one hydrometeor, the one on the most
// levels is used (grib_levels.cc).
constexpr std::array kRows = {
    Row{{0, 1, 22}, Ratio(Hydrometeor::kCloud), "CLMR", "QC", nullptr},
    Row{{0, 1, 83}, Specific(Hydrometeor::kCloud), "SPCLW", "CLWC", "clwc"},
    Row{{0, 6, 38}, Density(Hydrometeor::kCloud), "CLWDEN", nullptr, nullptr},
    Row{{0, 1, 24}, Ratio(Hydrometeor::kRain), "RWMR", "QR", nullptr},
    Row{{0, 1, 85}, Specific(Hydrometeor::kRain), "SPRW", "CRWC", "crwc"},
    Row{{0, 1, 96}, Density(Hydrometeor::kRain), "RWDEN", nullptr, nullptr},
    Row{{0, 1, 82}, Ratio(Hydrometeor::kIce), "CIMIXR", "QI", nullptr},
    Row{{0, 1, 23}, Ratio(Hydrometeor::kIce), "ICMR", "QI", nullptr},
    Row{{0, 6, 23}, Ratio(Hydrometeor::kIce), "CICE", "QI", nullptr},
    Row{{0, 1, 84}, Specific(Hydrometeor::kIce), "SPCIW", "CIWC", "ciwc"},
    Row{{0, 6, 39}, Density(Hydrometeor::kIce), "CIDEN", nullptr, nullptr},
    Row{{0, 1, 25}, Ratio(Hydrometeor::kSnow), "SNMR", "QS", nullptr},
    Row{{0, 1, 86}, Specific(Hydrometeor::kSnow), "SPSW", "CSWC", "cswc"},
    Row{{0, 1, 97}, Density(Hydrometeor::kSnow), "SNDEN", nullptr, nullptr},
    Row{{0, 1, 32}, Ratio(Hydrometeor::kGraupel), "GRLE", "QG", nullptr},
    Row{{0, 1, 98}, Density(Hydrometeor::kGraupel), "GRDEN", nullptr, nullptr},
    Row{{0, 1, 71}, Ratio(Hydrometeor::kHail), "HAILMXR", "QH", nullptr},
    Row{{0, 1, 99}, Density(Hydrometeor::kHail), "HADEN", nullptr, nullptr},
    Row{{0, 6, 28}, Number(Hydrometeor::kCloud), "NCONCD", "QNC", nullptr},
    Row{{0, 6, 29}, Number(Hydrometeor::kIce), "NCCICE", "QNI", nullptr},
    Row{{0, 1, 100}, Number(Hydrometeor::kRain), "SPNCR", "QNR", nullptr},
    Row{{0, 1, 101}, Number(Hydrometeor::kSnow), "SPNCS", "QNS", nullptr},
    Row{{0, 1, 102}, Number(Hydrometeor::kGraupel), "SPNCG", "QNG", nullptr},
    Row{{0, 1, 103}, Number(Hydrometeor::kHail), "SPNCH", "QNH", nullptr},
    Row{{0, 3, 4}, Only(GribKind::kGeopotential), "GP", "FI", "z"},
    Row{{0, 3, 5}, Only(GribKind::kGeopotentialHeight), "HGT", "GH", "gh"},
    Row{{0, 3, 6}, Only(GribKind::kGeometricHeight), "DIST", "HHL", "h"},
    Row{{0, 3, 0}, Only(GribKind::kPressure), "PRES", "P", "pres"},
    Row{{0, 3, 25}, Only(GribKind::kLogPressure), "NLGSP", "LNSP", "lnsp"},
    Row{{0, 0, 0}, Only(GribKind::kTemperature), "TMP", "T", "t"},
    Row{{0, 1, 0}, Only(GribKind::kSpecificHumidity), "SPFH", "QV", "q"},
    Row{{0, 1, 2}, Only(GribKind::kVapourRatio), "MIXR", "QV", "mixr"},
    Row{{0, 1, 1}, Only(GribKind::kRelativeHumidity), "RH", "RELHUM", "r"},
    Row{{0, 2, 2}, Only(GribKind::kWindX), "UGRD", "U", "u"},
    Row{{0, 2, 3}, Only(GribKind::kWindY), "VGRD", "V", "v"},
    Row{{0, 2, 9}, Only(GribKind::kAscent), "DZDT", "W", "wz"},
    Row{{0, 2, 8}, Only(GribKind::kOmega), "VVEL", "OMEGA", "w"},
    Row{{0, 19, 11}, Only(GribKind::kTurbulentEnergy), "TKE", "TKE", "tke"},
    Row{{0, 191, 1}, Only(GribKind::kCellLatitude), "GEOLAT", "CLAT", "tlat"},
    Row{{0, 191, 2}, Only(GribKind::kCellLongitude), "GEOLON", "CLON", "tlon"},
    Row{{2, 0, 0}, Only(GribKind::kLandShare), "LAND", "FR_LAND", "lsm"},
    Row{{2, 0, 198}, Only(GribKind::kLandUse), "VGTYP", nullptr, nullptr},
    Row{{0, 1, 42}, Only(GribKind::kSnowCover), "SNOWC", nullptr, nullptr},
    Row{{0, 19, 1}, Only(GribKind::kAlbedo), "ALBDO", "ALB_RAD", "al"},
    Row{{2, 0, 4}, Only(GribKind::kGreenCover), "VEG", "PLCOV", nullptr},
};

const Row* RowOf(const grib::Parameter& parameter) {
  const auto at = std::ranges::find(kRows, parameter, &Row::parameter);
  return at == kRows.end() ? nullptr : &*at;
}

// Numbers of centres (common code table C-11).
constexpr int kNcep = 7;
constexpr int kNoaaLaboratory = 59;
constexpr int kNcar = 60;
constexpr int kUkMetOffice = 74;
constexpr int kDwd = 78;
constexpr int kRome = 80;
constexpr int kMeteoFrance = 85;
constexpr int kToulouse = 84;
constexpr int kEcmwf = 98;
constexpr int kMeteoSwiss = 215;

bool HasDwdNames(int centre) { return centre == kDwd || centre == kMeteoSwiss || centre == kRome; }

std::string CentreName(int centre) {
  switch (centre) {
    case kNcep:
      return "NCEP";
    case kNoaaLaboratory:
      return "NOAA GSL";
    case kNcar:
      return "NCAR";
    case kUkMetOffice:
      return "UK Met Office";
    case kDwd:
      return "DWD";
    case kRome:
      return "Rome";
    case kToulouse:
    case kMeteoFrance:
      return "Meteo-France";
    case kEcmwf:
      return "ECMWF";
    case kMeteoSwiss:
      return "MeteoSwiss";
    case 34:
      return "JMA";
    case 54:
      return "CMC";
    case 86:
      return "FMI";
    case 88:
      return "MET Norway";
    case 94:
      return "DMI";
    case 99:
      return "KNMI";
    default:
      return absl::StrCat("centre ", centre);
  }
}

// NCEP's numbers of generating processes (its table A, Office Note 388). NAM (84) and others that
// are not here have models whose mixing ratios are not documented.
constexpr int kHrrr = 83;
constexpr int kRap = 105;
constexpr int kWrfArw = 116;
constexpr int kRrfs = 134;
constexpr int kHafs = 135;
constexpr std::array kGfs = {81, 82, 96, 107};

// Returns the name of a model of NCEP, or an empty text if it is not known.
std::string NcepModel(int process) {
  if (std::ranges::find(kGfs, process) != kGfs.end()) return "GFS";
  switch (process) {
    case kHrrr:
      return "HRRR";
    case kRap:
      return "RAP";
    case kWrfArw:
      return "WRF-ARW";
    case kRrfs:
      return "RRFS";
    case kHafs:
      return "HAFS";
    default:
      return "";
  }
}

}  // namespace

GribMeaning MeaningOf(const grib::Parameter& parameter) {
  const Row* const row = RowOf(parameter);
  return row == nullptr ? GribMeaning{} : row->meaning;
}

std::string GribNameOf(const grib::Parameter& parameter, int centre) {
  const Row* const row = RowOf(parameter);
  if (row == nullptr) return grib::NumbersOf(parameter);
  if (HasDwdNames(centre) && row->dwd != nullptr) return row->dwd;
  if (centre != kNcep && row->ecmwf != nullptr) return row->ecmwf;
  return row->ncep;
}

std::string GribKindName(GribKind kind) {
  const auto named = [kind](const char* name) {
    std::string numbers;
    for (const Row& row : kRows) {
      if (row.meaning.kind != kind) continue;
      absl::StrAppend(&numbers, numbers.empty() ? "" : ", ", grib::NumbersOf(row.parameter));
    }
    return absl::StrCat(name, " (", numbers, ")");
  };
  switch (kind) {
    case GribKind::kNone:
      return "nothing";
    case GribKind::kAmount:
      return named("hydrometeors");
    case GribKind::kNumber:
      return named("numbers of particles");
    case GribKind::kGeopotentialHeight:
      return named("geopotential height");
    case GribKind::kGeometricHeight:
      return named("height");
    case GribKind::kGeopotential:
      return named("geopotential");
    case GribKind::kPressure:
      return named("pressure");
    case GribKind::kLogPressure:
      return named("logarithm of the surface pressure");
    case GribKind::kTemperature:
      return named("temperature");
    case GribKind::kSpecificHumidity:
      return named("specific humidity");
    case GribKind::kVapourRatio:
      return named("vapour's mixing ratio");
    case GribKind::kRelativeHumidity:
      return named("relative humidity");
    case GribKind::kWindX:
    case GribKind::kWindY:
      return named("wind");
    case GribKind::kAscent:
    case GribKind::kOmega:
      return named("vertical wind");
    case GribKind::kTurbulentEnergy:
      return named("turbulent energy");
    case GribKind::kCellLatitude:
      return named("latitude of the cells");
    case GribKind::kCellLongitude:
      return named("longitude of the cells");
    case GribKind::kLandShare:
      return named("share of land");
    case GribKind::kLandUse:
      return named("land use");
    case GribKind::kSnowCover:
      return named("snow cover");
    case GribKind::kAlbedo:
      return named("albedo");
    case GribKind::kGreenCover:
      return named("vegetation");
  }
  return "";
}

GribModel ModelOf(const grib::Field& field) {
  const int centre = field.origin.centre;
  const int process = field.process;
  GribModel model;
  model.name = CentreName(centre);
  const std::string at_ncep = centre == kNcep ? NcepModel(process) : "";
  if (!at_ncep.empty()) absl::StrAppend(&model.name, " ", at_ncep);
  if (at_ncep == "HRRR" || at_ncep == "RAP" || centre == kNoaaLaboratory) {
    model.mixing_ratios_per = AirMass::kDry;
    model.why = "the WRF model, which HRRR and RAP use, writes them so";
    model.microphysics = physics::Microphysics::kThompson;
    return model;
  }
  if (at_ncep == "WRF-ARW") {
    model.mixing_ratios_per = AirMass::kDry;
    model.why = "the WRF model writes them so";
    return model;
  }
  if (centre == kNcar) {
    model.mixing_ratios_per = AirMass::kDry;
    model.why = "the models of NCAR, WRF and MPAS, write them so";
    return model;
  }
  model.mixing_ratios_per = AirMass::kWhole;
  if (!at_ncep.empty()) {
    model.splits_cloud = at_ncep == "GFS";
    model.why = "the FV3 model, which GFS, RRFS and HAFS use, writes them so";
  } else if (HasDwdNames(centre)) {
    absl::StrAppend(&model.name, " ICON or COSMO");
    model.why = "the models ICON and COSMO write them so";
  } else if (centre == kEcmwf) {
    absl::StrAppend(&model.name, " IFS");
    model.why = "the model IFS writes them so";
  } else if (centre == kMeteoFrance || centre == kToulouse) {
    model.why = "the models AROME and ARPEGE write them so";
  } else {
    model.mixing_ratios_per = AirMass::kDry;
    model.why = "the parameter's definition says so, and the model is not known";
  }
  return model;
}

bool HasModisClasses(const grib::Field& field) {
  return field.origin.centre == kNcep || field.origin.centre == kNoaaLaboratory;
}

}  // namespace thunderhead::storm_files
