#include "storm_files/cf_air.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/cell_methods.h"
#include "storm_files/cf_checks.h"
#include "storm_files/cf_isobaric.h"
#include "storm_files/cf_models.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// Returns whether a pressure or temperature is only the deviation from a base state. Then a whole
// column of the first time is far below the values of any atmosphere. PALM and MONC write such a p,
// and MONC such a th, and their names do not say so.
absl::StatusOr<bool> IsDeviation(const netcdf::NetcdfFile& file, const CfVariable& variable,
                                 const CfAir& air) {
  constexpr double kLeastPressure_Pa = 5000.0;
  constexpr double kLeastTemperature_K = 100.0;
  double least = 0.0;
  if (air.variable == AirVariable::kPressure) {
    least = kLeastPressure_Pa;
  } else if (air.variable == AirVariable::kTemperature ||
             air.variable == AirVariable::kPotentialTemperature) {
    least = kLeastTemperature_K;
  } else {
    return false;
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto shape, file.Shape(variable.name));
  const std::vector<std::size_t> start(shape.size(), 0);
  std::vector<std::size_t> count(shape.size(), 1);
  const auto z = static_cast<std::size_t>(variable.places[2]);
  count[z] = shape[z];
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> column,
                               file.ReadPart(variable.name, start, count));
  bool any = false;
  for (const float written : column) {
    const double value = written * air.scale + air.offset;
    if (std::isnan(value)) continue;
    if (value >= least) return false;
    any = true;
  }
  return any;
}

// Finds the variables of the air and adds them to the metadata.
class AirFinder {
 public:
  AirFinder(const netcdf::NetcdfFile& file, CfMetadata& metadata)
      : file_(file), metadata_(metadata) {}

  // Takes the variables on all axes, or the profiles along z for what is still missing, such as the
  // base state of an anelastic model.
  absl::Status Take(const std::vector<CfDescription>& variables, bool profiles) {
    for (const CfDescription& variable : variables) {
      const std::optional<CfAir> air = AirVariableOf(variable);
      if (!air.has_value() || Has(metadata_, air->variable)) continue;
      if (HoldsNoAmount(file_, variable.name) || IsUnnamedLevels(variable)) continue;
      if (profiles ? !IsProfile(variable.name) : !MayBeOnAllAxes(variable.name)) continue;
      if (!air->known_units) return WrongUnits(file_, variable, "kg m-3, Pa, K or kg kg-1");
      THUNDERHEAD_RETURN_IF_ERROR(TakeOne(variable, *air, profiles));
    }
    return absl::OkStatus();
  }

  // Takes the coordinate of the layers as the pressure if its units are those of a pressure, and
  // nothing says that it is the nominal pressure of model levels.
  absl::Status TakeLevels() {
    const std::string& name = metadata_.dimensions.axes[2].coordinate;
    if (name.empty() || Has(metadata_, AirVariable::kPressure) ||
        metadata_.heights.kind == CfHeightKind::kPressure || !HoldsAirPressure(file_, name)) {
      return absl::OkStatus();
    }
    const CfDescription levels = DescribeCf(file_, name);
    const auto conversion = ConversionOf(levels.units, "Pa");
    if (!conversion.has_value() || !levels.standard_name.empty() || !IsProfile(name)) {
      return absl::OkStatus();
    }
    metadata_.assumptions.push_back(
        absl::StrCat("The levels ", name, " are the air's pressure, by their units."));
    return TakeOne(levels,
                   {.variable = AirVariable::kPressure,
                    .scale = conversion->scale,
                    .offset = conversion->offset},
                   true);
  }

  // The names of deviations from a base state that is not known.
  const std::vector<std::string>& Deviations() const { return deviations_; }

 private:
  // Returns whether the variable is the coordinate of the layers and has no standard name.
  // TakeLevels decides on it.
  bool IsUnnamedLevels(const CfDescription& variable) const {
    return variable.standard_name.empty() &&
           variable.name == metadata_.dimensions.axes[2].coordinate;
  }

  bool IsProfile(const std::string& name) const {
    const auto arranged = Arrange(file_, name, metadata_.dimensions);
    return arranged.ok() && arranged->places[2] >= 0 && arranged->places[0] < 0 &&
           arranged->places[1] < 0 && OnCells(*arranged);
  }

  bool MayBeOnAllAxes(const std::string& name) const {
    const auto shape = file_.Shape(name);
    return shape.ok() && shape->size() >= RankOf(metadata_) &&
           !HasFewerAxes(file_, name, metadata_);
  }

  absl::Status TakeOne(const CfDescription& variable, const CfAir& air, bool profile) {
    if (air.variable == AirVariable::kPressureDeviation && !HasReference()) {
      deviations_.push_back(variable.name);
      return absl::OkStatus();
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(CfVariable arranged,
                                 profile ? Arrange(file_, variable.name, metadata_.dimensions)
                                         : ArrangeOnCells(file_, variable.name, metadata_));
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool is_deviation, IsDeviation(file_, arranged, air));
    if (is_deviation) {
      deviations_.push_back(variable.name);
      return absl::OkStatus();
    }
    if (HasNoUnits(variable.units)) {
      spdlog::warn("{}: {} has no units; taken to be in kg m-3, Pa, K or kg kg-1", file_.Path(),
                   variable.name);
      metadata_.assumptions.push_back(absl::StrCat(
          variable.name, " has no units; it is taken to be in kg m-3, Pa, K or kg kg-1."));
    }
    if (profile) {
      metadata_.assumptions.push_back(
          absl::StrCat("The air's ", variable.name, " is the same in all columns."));
    }
    metadata_.air.push_back({std::move(arranged), air});
    return absl::OkStatus();
  }

  // Finds the reference atmosphere of pressure deviations. Heights must be known independently.
  bool HasReference() {
    if (FollowFromAir(metadata_.heights.kind)) return false;
    if (!metadata_.reference.has_value()) metadata_.reference = ReadReferenceAtmosphere(file_);
    return metadata_.reference.has_value();
  }

  const netcdf::NetcdfFile& file_;
  CfMetadata& metadata_;
  std::vector<std::string> deviations_;
};

// If the file has both the whole pressure and its deviation from a reference state, removes the
// deviation. If it has only the deviation, adds an assumption that names the reference.
void ChoosePressure(CfMetadata& metadata) {
  const auto deviation =
      std::ranges::find(metadata.air, AirVariable::kPressureDeviation,
                        [](const CfAirField& field) { return field.air.variable; });
  if (deviation == metadata.air.end()) return;
  if (Has(metadata, AirVariable::kPressure)) {
    metadata.air.erase(deviation);
    return;
  }
  metadata.assumptions.push_back(absl::StrCat(
      "The pressure is ", deviation->variable.name, " plus that of COSMO's reference atmosphere, ",
      "by the attributes of ", metadata.reference->variable, "."));
}

absl::Status CheckMixtures(const netcdf::NetcdfFile& file, bool warm, CfMetadata& metadata) {
  std::string before;
  for (const CfField& field : metadata.fields) {
    const std::string& name = field.variable.name;
    if (field.quantity.mixed == MixedWater::kNone || name == before) continue;
    before = name;
    const bool cloud = field.quantity.mixed == MixedWater::kCloud;
    const char* const holds = cloud ? "cloud water and ice" : "rain, snow and graupel";
    if (!warm) {
      return absl::InvalidArgumentError(absl::StrCat(
          file.Path(), ": ", name, " holds ", holds,
          ", which only the temperature tells apart, and the file lacks it; add TABS or "
          "air_temperature (K)"));
    }
    metadata.assumptions.push_back(absl::StrCat(
        name, " is divided into ", holds, " by temperature, as in SAM's single-moment scheme: ",
        cloud ? "ice below 253.16 K, liquid above 273.16 K, and a linear mixture between."
              : "rain above 283.16 K, none below 268.16 K, and graupel in the ice from 223.16 K."));
  }
  return absl::OkStatus();
}

absl::Status LacksDensity(const netcdf::NetcdfFile& file, const CfField& ratio,
                          const std::vector<std::string>& deviations) {
  const std::string reason =
      deviations.empty()
          ? ""
          : absl::StrCat(" (", absl::StrJoin(deviations, " and "), " ",
                         deviations.size() == 1 ? "is only the deviation" : "are only deviations",
                         " from a reference state)");
  const std::string advice = AdviceOnAir(file);
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": ", ratio.variable.name,
                   " is per kg of air, and the file lacks the air's ", "density", reason, "; ",
                   advice.empty() ? "add air_density (kg m-3), or the whole air_pressure (Pa) with "
                                    "air_temperature (K), or give masses in kg m-3"
                                  : advice));
}

}  // namespace

absl::Status FindCfAir(const netcdf::NetcdfFile& file, const std::vector<CfDescription>& variables,
                       CfMetadata* metadata) {
  const auto ratio = std::ranges::find_if(metadata->fields, [](const CfField& field) {
    return field.quantity.quantity == volume::Quantity::kMixingRatio;
  });
  const bool mixed = std::ranges::any_of(metadata->fields, [](const CfField& field) {
    return field.quantity.mixed != MixedWater::kNone;
  });
  const bool hydrostatic = FollowFromAir(metadata->heights.kind);
  if (ratio == metadata->fields.end() && !hydrostatic && !mixed) return absl::OkStatus();
  AirFinder finder(file, *metadata);
  THUNDERHEAD_RETURN_IF_ERROR(finder.Take(variables, false));
  THUNDERHEAD_RETURN_IF_ERROR(finder.Take(variables, true));
  THUNDERHEAD_RETURN_IF_ERROR(finder.TakeLevels());
  ChoosePressure(*metadata);
  const bool pressure = hydrostatic || Has(*metadata, AirVariable::kPressure) ||
                        Has(*metadata, AirVariable::kPressureDeviation);
  const bool warm = Has(*metadata, AirVariable::kTemperature) ||
                    (pressure && Has(*metadata, AirVariable::kPotentialTemperature));
  if (hydrostatic && !warm) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": the heights of ", metadata->heights.name,
        " follow from pressure and temperature, and the file lacks air_temperature (K); add it, or "
        "an array of heights"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckMixtures(file, warm, *metadata));
  if (ratio == metadata->fields.end()) return absl::OkStatus();
  if (Has(*metadata, AirVariable::kDensity) || (pressure && warm)) return absl::OkStatus();
  return LacksDensity(file, *ratio, finder.Deviations());
}

}  // namespace thunderhead::storm_files
