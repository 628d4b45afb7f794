#include "storm_files/wrf_reader.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/even_columns.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/ground.h"

namespace thunderhead::storm_files {
namespace {

constexpr float kVapourToDryGas = 461.6F / 287.0F;  // Rv / Rd, as in WRF

// Snow of this depth hides short plants.
constexpr float kCoveringSnow_m = 0.1F;

class WrfSource final : public LayerSource {
 public:
  WrfSource(std::shared_ptr<const WrfMetadata> metadata, std::size_t record,
            netcdf::NetcdfFile file, std::shared_ptr<const EvenColumns> even)
      : shared_metadata_(std::move(metadata)), file_(std::move(file)) {
    domain_.path = metadata_.path;
    domain_.record = record;
    domain_.time = metadata_.times[record];
    domain_.cells = metadata_.cells;
    const glm::dvec2 distances_m = metadata_.DistancesOf(even.get());
    domain_.dx_m = distances_m.x;
    domain_.dy_m = distances_m.y;
    domain_.even = std::move(even);
    domain_.on_terrain = !metadata_.heights.middles.per_level;
    domain_.heights_from = HeightsFrom();
    domain_.ground_from = "HGT";
    domain_.air_from = AirFrom();
    domain_.vapour_from = metadata_.air.has_vapour ? "QVAPOR" : "";
    domain_.microphysics = metadata_.microphysics;
    for (const physics::Hydrometeor hydrometeor : metadata_.fields) {
      LayerField& field = domain_.fields.emplace_back();
      field.hydrometeor = hydrometeor;
      field.variable = metadata_.variables[physics::IndexOf(hydrometeor)];
      field.sizes = metadata_.sizes[physics::IndexOf(hydrometeor)];
    }
  }

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override;
  absl::StatusOr<LayerState> Air() override;
  absl::StatusOr<LayerAmounts> Amounts(std::size_t field) override;
  absl::StatusOr<std::vector<float>> Terrain_m() override;
  absl::StatusOr<volume::LandColumns> Land() override;
  absl::StatusOr<LayerEnergy> TurbulentEnergy() override;
  absl::StatusOr<ModelWind> Wind() override;

 private:
  std::size_t Cells() const { return static_cast<std::size_t>(domain_.cells.z) * Columns(); }
  std::size_t Columns() const { return domain_.Columns(); }
  std::string HeightsFrom() const;
  std::string AirFrom() const;
  absl::Status ReadVariable(const std::string& variable, std::size_t values_expected,
                            Changes changes, std::vector<float>& values,
                            netcdf::HugeValue huge = netcdf::HugeValue::kRefused);
  absl::Status ReadTerm(const WrfTerm& term, Changes changes, std::vector<float>& values);
  absl::Status ReadColumns(const std::string& variable, std::vector<float>& values);
  absl::StatusOr<std::vector<float>> HeightsFromMiddles_m();
  absl::Status AddMoreIce(std::vector<float>& amounts);
  absl::Status SplitPhases(physics::Hydrometeor hydrometeor, std::vector<float>& amounts);
  void DryPotentialTemperature(LayerState& state) const;

  const std::shared_ptr<const WrfMetadata> shared_metadata_;
  const WrfMetadata& metadata_ = *shared_metadata_;
  LayerDomain domain_;
  netcdf::NetcdfFile file_;
  std::vector<float> ice_share_;  // in each cell, if variables hold both phases
};

std::string WrfSource::HeightsFrom() const {
  const WrfHeights& heights = metadata_.heights;
  return heights.perturbation.empty() ? heights.middles.variable
                                      : absl::StrCat(heights.perturbation, " + ", heights.base);
}

std::string WrfSource::AirFrom() const {
  const WrfAir& air = metadata_.air;
  std::vector<std::string> names;
  for (const WrfTerm& term : air.pressure) names.push_back(term.variable);
  const std::string pressure = absl::StrJoin(names, " + ");
  const std::string& temperature = air.temperature.variable;
  return absl::StrCat(pressure, " (Pa) and ", temperature,
                      air.potential && air.temperature.offset != 0.0
                          ? " (K, the potential temperature minus 300 K)"
                          : " (K)");
}

absl::Status WrfSource::ReadVariable(const std::string& variable, std::size_t values_expected,
                                     Changes changes, std::vector<float>& values,
                                     netcdf::HugeValue huge) {
  // The length is checked before memory is allocated for it.
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t length,
                               ValuesOfTime(file_, variable, kRankOfLayers));
  if (length != values_expected) {
    return absl::DataLossError(absl::StrCat(
        file_.Path(), ": ", variable, " now has ", length, " values a time where it had ",
        values_expected, "; the file was replaced: restart the server to read the new file"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadTime(file_, variable, kRankOfLayers, domain_.record, changes, values, huge));
  if (std::ranges::all_of(values, [](float value) { return std::isnan(value); })) {
    return absl::DataLossError(absl::StrCat(file_.Path(), ": ", variable, " of record ",
                                            domain_.record, " holds nothing but fill values; ",
                                            "write the file again, with this variable"));
  }
  return absl::OkStatus();
}

// Reads a quantity in layers in SI units.
absl::Status WrfSource::ReadTerm(const WrfTerm& term, Changes changes, std::vector<float>& values) {
  if (term.per_level) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> levels,
                                 file_.ReadDoubles(term.variable));
    if (levels.size() * Columns() != Cells()) {
      return absl::DataLossError(
          absl::StrCat(file_.Path(), ": ", term.variable, " now has ", levels.size(),
                       " values; the file was replaced: restart the server to read the new file"));
    }
    values.clear();
    for (const double level : levels) {
      values.insert(values.end(), Columns(), static_cast<float>(level));
    }
  } else {
    THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(term.variable, Cells(), changes, values));
  }
  if (term.scale == 1.0 && term.offset == 0.0) return absl::OkStatus();
  const auto scale = static_cast<float>(term.scale);
  const auto offset = static_cast<float>(term.offset);
  for (float& value : values) value = value * scale + offset;
  return absl::OkStatus();
}

// Reads a variable with one value for each column. Nothing is read if the name is empty.
absl::Status WrfSource::ReadColumns(const std::string& variable, std::vector<float>& values) {
  if (variable.empty()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadTime(file_, variable, kRankOfColumns, domain_.record, Changes::kNever, values));
  values.resize(Columns(), std::nanf(""));
  return absl::OkStatus();
}

absl::StatusOr<std::vector<float>> WrfSource::InterfaceHeights_m() {
  const WrfHeights& names = metadata_.heights;
  if (names.perturbation.empty()) return HeightsFromMiddles_m();
  std::vector<float> heights_m;
  std::vector<float> base;
  const std::size_t values = Cells() + Columns();
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadVariable(names.perturbation, values, Changes::kAtEachTime, heights_m));
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(names.base, values, Changes::kNever, base));
  GeopotentialToHeight(base, heights_m);
  return heights_m;
}

absl::StatusOr<std::vector<float>> WrfSource::HeightsFromMiddles_m() {
  std::vector<float> middles_m;
  THUNDERHEAD_RETURN_IF_ERROR(ReadTerm(metadata_.heights.middles, Changes::kAtEachTime, middles_m));
  std::vector<float> ground_m;
  if (domain_.on_terrain) {
    THUNDERHEAD_ASSIGN_OR_RETURN(ground_m, Terrain_m());
  }
  std::vector<float> heights_m = InterfacesBetween(middles_m, ground_m, domain_.cells.z, Columns());
  RaiseToGround(ground_m, heights_m);
  return heights_m;
}

// Turns the potential temperature of moist air into that of dry air.
void WrfSource::DryPotentialTemperature(LayerState& state) const {
  if (!metadata_.air.moist || state.vapour_kg_per_kg.empty()) return;
  for (std::size_t i = 0; i < state.vapour_kg_per_kg.size(); ++i) {
    const float vapour = std::max(state.vapour_kg_per_kg[i], 0.0F);
    // Impossible vapour must not make the temperature impossible, because it is the cause of the
    // error that the user gets.
    if (vapour > kHighestVapour_kg_per_kg) continue;
    state.potential_temperature_K[i] /= 1.0F + kVapourToDryGas * vapour;
  }
}

absl::StatusOr<LayerState> WrfSource::Air() {
  const WrfAir& air = metadata_.air;
  LayerState state;
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadTerm(air.pressure.front(), Changes::kAtEachTime, state.pressure_Pa));
  if (air.pressure.size() > 1) {
    std::vector<float> base_Pa;
    THUNDERHEAD_RETURN_IF_ERROR(ReadTerm(air.pressure.back(), Changes::kNever, base_Pa));
    for (std::size_t i = 0; i < base_Pa.size(); ++i) state.pressure_Pa[i] += base_Pa[i];
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadTerm(air.temperature, Changes::kAtEachTime,
               air.potential ? state.potential_temperature_K : state.temperature_K));
  if (air.has_vapour) {
    THUNDERHEAD_RETURN_IF_ERROR(
        ReadVariable("QVAPOR", Cells(), Changes::kAtEachTime, state.vapour_kg_per_kg));
  }
  DryPotentialTemperature(state);
  if (metadata_.split != PhaseSplit::kNone) {
    ice_share_ = Temperature(state);
    for (float& each : ice_share_) each = IceShare(metadata_.split, each);
  }
  return state;
}

// Keeps the phase `hydrometeor` of amounts of both phases.
absl::Status WrfSource::SplitPhases(physics::Hydrometeor hydrometeor, std::vector<float>& amounts) {
  if (!metadata_.IsShared(hydrometeor)) return absl::OkStatus();
  if (ice_share_.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(Air().status());
  }
  const bool frozen =
      hydrometeor == physics::Hydrometeor::kIce || hydrometeor == physics::Hydrometeor::kSnow;
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    amounts[i] *= frozen ? ice_share_[i] : 1.0F - ice_share_[i];
  }
  return absl::OkStatus();
}

absl::Status WrfSource::AddMoreIce(std::vector<float>& amounts) {
  for (const std::string& variable : metadata_.more_ice) {
    std::vector<float> more;
    THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(variable, Cells(), Changes::kAtEachTime, more));
    for (std::size_t i = 0; i < amounts.size(); ++i) amounts[i] += more[i];
  }
  return absl::OkStatus();
}

absl::StatusOr<LayerAmounts> WrfSource::Amounts(std::size_t field) {
  const LayerField& from = domain_.fields[field];
  LayerAmounts read;
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadVariable(from.variable, Cells(), Changes::kAtEachTime, read.amounts));
  if (from.hydrometeor == physics::Hydrometeor::kIce) {
    THUNDERHEAD_RETURN_IF_ERROR(AddMoreIce(read.amounts));
  }
  THUNDERHEAD_RETURN_IF_ERROR(SplitPhases(from.hydrometeor, read.amounts));
  if (!from.sizes.name.empty()) {
    // Models divide by zero where there are no particles. Such sizes are replaced like other sizes
    // that no particle can have.
    THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(from.sizes.name, Cells(), Changes::kAtEachTime,
                                             read.sizes, netcdf::HugeValue::kMissing));
  }
  return read;
}

absl::StatusOr<std::vector<float>> WrfSource::Terrain_m() {
  std::vector<float> terrain_m;
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(metadata_.has_terrain ? "HGT" : "", terrain_m));
  return terrain_m;
}

// Reads the land cover for this record, because snow cover changes with time.
absl::StatusOr<volume::LandColumns> WrfSource::Land() {
  const WrfLand& names = metadata_.land;
  volume::LandColumns columns;
  if (names.land_use.empty()) return columns;
  columns.scheme = names.scheme;
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.land_use, columns.land_use));
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.mask, columns.water));
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.albedo, columns.albedo));
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.green, columns.green_percent));
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.snow_share, columns.snow_share));
  THUNDERHEAD_RETURN_IF_ERROR(ReadColumns(names.snow_depth, columns.snow_share));
  for (float& water : columns.water) water = names.mask == "XLAND" ? water - 1.0F : 1.0F - water;
  if (!names.snow_depth.empty()) {
    for (float& snow : columns.snow_share) snow /= kCoveringSnow_m;
  }
  return columns;
}

absl::StatusOr<LayerEnergy> WrfSource::TurbulentEnergy() {
  const WrfMetadata::Energy& variable = metadata_.energy;
  LayerEnergy read{variable.name, {}};
  if (variable.name.empty()) return read;
  std::vector<float>& energy = read.energy_m2_per_s2;
  const std::size_t values = Cells() + (variable.at_interfaces ? Columns() : 0);
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(variable.name, values, Changes::kAtEachTime, energy));
  if (variable.at_interfaces) energy = LayerMeans(energy, domain_.cells.z, Columns());
  if (variable.doubled) {
    for (float& value : energy) value *= 0.5F;
  }
  return read;
}

absl::StatusOr<ModelWind> WrfSource::Wind() {
  ModelWind wind;
  const auto& [u, v, w] = metadata_.wind;
  if (u.empty()) return wind;
  wind.cells = domain_.cells;
  wind.dx_m = domain_.dx_m;
  wind.dy_m = domain_.dy_m;
  const auto walls = static_cast<std::size_t>(domain_.cells.z);
  const std::size_t more_u = walls * static_cast<std::size_t>(domain_.cells.y);
  const std::size_t more_v = walls * static_cast<std::size_t>(domain_.cells.x);
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadVariable(u, Cells() + more_u, Changes::kAtEachTime, wind.u_m_per_s));
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadVariable(v, Cells() + more_v, Changes::kAtEachTime, wind.v_m_per_s));
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadVariable(w, Cells() + Columns(), Changes::kAtEachTime, wind.w_m_per_s));
  return wind;
}

}  // namespace

absl::StatusOr<std::unique_ptr<LayerSource>> OpenWrfTime(
    std::shared_ptr<const WrfMetadata> metadata, std::size_t record) {
  THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(metadata->path));
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const EvenColumns> even,
                               EvenColumnsAt(*metadata, file, record));
  return std::make_unique<WrfSource>(std::move(metadata), record, std::move(file), std::move(even));
}

absl::StatusOr<volume::HydrometeorFields> ReadWrfTime(const WrfMetadata& metadata,
                                                      std::size_t record,
                                                      const std::optional<VerticalGrid>& grid,
                                                      const ReadCheckpoint& checkpoint) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<LayerSource> source,
                               OpenWrfTime(std::make_shared<WrfMetadata>(metadata), record));
  return ReadOnHeights(*source, record, grid, checkpoint);
}

}  // namespace thunderhead::storm_files
