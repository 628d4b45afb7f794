#include "storm_files/fields_on_heights.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/field_scan.h"
#include "storm_files/ground.h"
#include "storm_files/storm_columns.h"
#include "storm_files/windowed_source.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

// The largest amount in kg/kg or kg/m3 that is accepted. Air never carries half its mass in
// condensate, so larger values are in g.
constexpr float kMaxAmount = 0.5F;

struct RemappedField {
  volume::HydrometeorField field;
  volume::CellBox condensate;
};

// Reads one time. Variables are read on the calling thread, one at a time. At the same time another
// thread remaps the previous variable, because reading and remapping take about equally long.
class TimeReader {
 public:
  TimeReader(LayerSource& source, int stride)
      : source_(source), domain_(source.Domain()), columns_(domain_, stride) {
    air_.levels = domain_.cells.z;
    air_.columns = domain_.Columns();
  }

  absl::StatusOr<VerticalGrid> ReadHeights();
  absl::StatusOr<volume::HydrometeorFields> Read(const std::optional<VerticalGrid>& grid,
                                                 const ReadCheckpoint& checkpoint);

 private:
  absl::Status Advance();
  absl::Status CheckSize(const std::string& what, const std::vector<float>& values,
                         std::size_t expected) const;
  absl::StatusOr<VerticalGrid> GridFor(const std::optional<VerticalGrid>& storm_grid) const;
  std::string GroundOfRecord() const;
  absl::Status ReadGround();
  absl::Status CutLayersAtGround();
  void TakeTerrain(volume::HydrometeorFields& result);
  absl::Status ReadLand(volume::HydrometeorFields& result);
  absl::StatusOr<std::shared_future<void>> ReadAir();
  absl::Status CheckVapour(const LayerState& state) const;
  absl::StatusOr<std::vector<float>> CondensateShare();
  absl::Status ReadFields(volume::HydrometeorFields& result);
  absl::Status CheckAir() const;
  absl::Status CheckAirOf(const LayerField& from, const std::vector<float>& amounts) const;
  const std::vector<float>& DensityFor(const LayerField& field) const;
  absl::StatusOr<RemappedField> Remap(const LayerField& from, LayerAmounts amounts) const;
  volume::ParticleSizes OriginOf(const LayerField& from) const;
  void RemapSizes(const std::vector<float>& concentration, std::vector<float> radii, double factor,
                  volume::HydrometeorField& field) const;
  volume::AirDensity MeanDensity(const std::vector<float>& density_kg_per_m3) const;
  double Highest_m() const;
  void SetGrid();
  std::vector<float> WithoutBuriedParts(const std::vector<float>& values) const;
  std::vector<float> OntoHeights(const std::vector<float>& values) const;
  std::vector<std::uint8_t> BytesOntoGrid(const std::vector<float>& values) const;
  absl::Status ReadMotion(volume::HydrometeorFields& result);
  void TakeWind(const ModelWind& wind, volume::HydrometeorFields& result) const;
  glm::dvec2 AlongAxes(const ModelWind& wind, const glm::dvec2& mean_m_per_s) const;
  bool NeedsAir() const;
  bool NeedsWholeAir() const;
  bool NeedsTemperature() const;

  LayerSource& source_;
  const LayerDomain& domain_;
  const StormColumns columns_;
  LayerAir air_;
  VerticalGrid own_grid_;
  VerticalGrid grid_;
  std::vector<float> ground_m_;  // height by column, NaN if missing; empty if the source has none
  // The bottoms and tops of layers before they were cut at the ground. Empty if none was cut.
  std::vector<float> uncut_m_;
  // True if the layers are the grid's cells in every column, before they were cut at the ground.
  bool layers_are_cells_ = false;
  volume::RegularGrid regular_;
  ReadCheckpoint checkpoint_;
  int steps_done_ = 0;
};

absl::Status TimeReader::Advance() {
  if (!checkpoint_) return absl::OkStatus();
  // Each field is a step. Heights, ground, air, turbulence, wind and the end are six more. The
  // first step reports 0.
  const auto steps = static_cast<double>(domain_.fields.size() + 5);
  return checkpoint_(std::min(1.0, steps_done_++ / steps));
}

absl::Status TimeReader::CheckSize(const std::string& what, const std::vector<float>& values,
                                   std::size_t expected) const {
  if (values.size() == expected) return absl::OkStatus();
  return absl::InternalError(absl::StrCat(domain_.path, ": ", what, " has ", values.size(),
                                          " values where ", expected, " are expected"));
}

// Replaces heights that no atmosphere has by NaN. A damaged temperature gives infinite heights, and
// fill values are huge.
void LeaveOutImpossible(std::vector<float>& heights_m) {
  constexpr float kHighest_m = 1e6F;
  for (float& height_m : heights_m) {
    // The negated comparison is also true for NaN.
    if (!(std::abs(height_m) < kHighest_m)) height_m = std::nanf("");
  }
}

// Returns whether the layers of every column run downwards. The lowest interface may be the ground,
// so it says nothing.
bool RunDownwards(const LayerAir& air) {
  const auto last = static_cast<std::size_t>(air.levels);
  const std::size_t first = last > 1 ? 1 : 0;
  bool any = false;
  for (std::size_t i = 0; i < air.columns; ++i) {
    const float low_m = air.interface_height_m[first * air.columns + i];
    const float high_m = air.interface_height_m[last * air.columns + i];
    if (std::isnan(low_m) || std::isnan(high_m)) continue;
    if (high_m >= low_m) return false;
    any = true;
  }
  return any;
}

// Returns the height at which a grid for uneven layers ends. There is no limit for extinction,
// because it may belong to something else than clouds.
double TimeReader::Highest_m() const {
  const bool is_cloud = std::ranges::none_of(domain_.fields, [](const LayerField& field) {
    return field.quantity == volume::Quantity::kExtinction;
  });
  return is_cloud ? kHighestCloud_m : std::numeric_limits<double>::infinity();
}

std::string TimeReader::GroundOfRecord() const {
  return absl::StrCat(domain_.path, ": ", domain_.ground_from, ", the height of the ground, of ",
                      "record ", domain_.record);
}

absl::Status TimeReader::ReadGround() {
  THUNDERHEAD_ASSIGN_OR_RETURN(ground_m_, source_.Terrain_m());
  if (ground_m_.empty()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckSize("the ground", ground_m_, air_.columns));
  return CheckGround(GroundOfRecord(), ground_m_, static_cast<std::size_t>(domain_.cells.x));
}

// Empties the layers below the ground, if the layers do not begin there. The grid of heights is
// chosen before, so it does not depend on the ground.
absl::Status TimeReader::CutLayersAtGround() {
  if (domain_.on_terrain || ground_m_.empty()) return absl::OkStatus();
  uncut_m_ = air_.interface_height_m;
  if (!RaiseToGround(ground_m_, air_.interface_height_m)) {
    uncut_m_ = {};
    return absl::OkStatus();
  }
  for (std::size_t i = 0; i + air_.columns < uncut_m_.size(); ++i) {
    if (air_.interface_height_m[i + air_.columns] > air_.interface_height_m[i]) {
      return absl::OkStatus();
    }
  }
  return absl::InvalidArgumentError(
      absl::StrCat(GroundOfRecord(), " is above all layers (", domain_.heights_from,
                   "); check whether both heights are above sea level and in their right units"));
}

absl::StatusOr<VerticalGrid> TimeReader::ReadHeights() {
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  THUNDERHEAD_RETURN_IF_ERROR(ReadGround());
  THUNDERHEAD_ASSIGN_OR_RETURN(air_.interface_height_m, source_.InterfaceHeights_m());
  THUNDERHEAD_RETURN_IF_ERROR(
      CheckSize("the layers' heights", air_.interface_height_m, (air_.levels + 1) * air_.columns));
  LeaveOutImpossible(air_.interface_height_m);
  if (RunDownwards(air_)) {
    return absl::InvalidArgumentError(absl::StrCat(
        domain_.path, ": ", domain_.heights_from, " of record ", domain_.record,
        " run downwards, and layers upwards are needed; reverse the order of the levels, for "
        "example with cdo invertlev or ncpdq"));
  }
  own_grid_ = domain_.fixed_heights
                  ? GridOfEvenLayers(air_.interface_height_m, air_.levels, air_.columns)
                  : VerticalGrid{};
  if (own_grid_.cells > 0) return own_grid_;
  own_grid_ = ChooseVerticalGrid(air_.interface_height_m, air_.levels, air_.columns, Highest_m());
  if (own_grid_.cells == 0) {
    return absl::DataLossError(
        absl::StrCat(domain_.path, ": ", domain_.heights_from, " of record ", domain_.record,
                     " give no layer whose top is above its bottom; write the file again"));
  }
  return own_grid_;
}

absl::StatusOr<VerticalGrid> TimeReader::GridFor(
    const std::optional<VerticalGrid>& storm_grid) const {
  if (!storm_grid.has_value()) return own_grid_;
  const VerticalGrid grid = Extended(*storm_grid, air_.interface_height_m, Highest_m());
  constexpr int kFewCells = 8;
  if (grid.cells <= 2 * storm_grid->cells + kFewCells) return grid;
  return absl::DataLossError(absl::StrCat(
      domain_.path, ": the heights of record ", domain_.record, " (", domain_.heights_from,
      ") reach from ", grid.low_m, " to ", grid.High_m(), " m where the storm's first time has ",
      storm_grid->low_m, " to ", storm_grid->High_m(), " m; give files of one run only"));
}

// Sets the terrain. In columns without a height, the ground is the lowest interface. If the layers
// do not follow the terrain, it is at sea level or, if lower, at the bottom of the domain.
void TimeReader::TakeTerrain(volume::HydrometeorFields& result) {
  std::vector<float> terrain = ground_m_;
  const auto bottom_m = static_cast<float>(grid_.low_m);
  terrain.resize(air_.columns, std::nanf(""));
  for (std::size_t i = 0; i < air_.columns; ++i) {
    if (!std::isnan(terrain[i])) continue;
    terrain[i] = domain_.on_terrain ? air_.interface_height_m[i] : std::min(0.0F, bottom_m);
    if (std::isnan(terrain[i])) terrain[i] = bottom_m;
  }
  result.terrain_height_m = columns_.Of(std::move(terrain), Beyond::kNearest);
}

absl::Status TimeReader::ReadLand(volume::HydrometeorFields& result) {
  THUNDERHEAD_ASSIGN_OR_RETURN(volume::LandColumns columns, source_.Land());
  if (columns.land_use.empty()) return absl::OkStatus();
  for (std::vector<float>* values : {&columns.land_use, &columns.water, &columns.albedo,
                                     &columns.green_percent, &columns.snow_share}) {
    *values = columns_.NearestOf(std::move(*values));
  }
  result.land = volume::MakeLandSurface(columns, glm::ivec2(regular_.cells));
  return absl::OkStatus();
}

bool TimeReader::NeedsAir() const {
  return std::ranges::any_of(domain_.fields, [](const LayerField& field) {
    return field.quantity == volume::Quantity::kMixingRatio;
  });
}

bool TimeReader::NeedsWholeAir() const {
  return std::ranges::any_of(domain_.fields, [](const LayerField& field) {
    return field.quantity == volume::Quantity::kMixingRatio && field.per == AirMass::kWhole;
  });
}

// Returns whether the sizes of snow come from the scheme's distribution, which depends on
// temperature.
bool TimeReader::NeedsTemperature() const {
  return physics::HasDistribution(domain_.microphysics, Hydrometeor::kSnow) &&
         std::ranges::find(domain_.fields, Hydrometeor::kSnow, &LayerField::hydrometeor) !=
             domain_.fields.end();
}

// Returns for each cell the share of the whole mass that is condensate, from the fields that are
// given per mass of the whole air.
absl::StatusOr<std::vector<float>> TimeReader::CondensateShare() {
  std::vector<float> share(air_.levels * air_.columns, 0.0F);
  for (std::size_t i = 0; i < domain_.fields.size(); ++i) {
    const LayerField& field = domain_.fields[i];
    if (field.quantity != volume::Quantity::kMixingRatio || field.per != AirMass::kWhole) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(const LayerAmounts from, source_.Amounts(i));
    THUNDERHEAD_RETURN_IF_ERROR(CheckSize(field.variable, from.amounts, share.size()));
    for (std::size_t cell = 0; cell < share.size(); ++cell) {
      const float amount = from.amounts[cell];
      if (amount > 0.0F && amount < kMaxAmount) share[cell] += amount;
    }
  }
  for (float& each : share) each = std::min(each, kMaxAmount);
  return share;
}

// Returns an error if usable air has more vapour than air can hold, as it has if the file's values
// are in g/kg.
absl::Status TimeReader::CheckVapour(const LayerState& state) const {
  const std::optional<float> vapour =
      ImpossibleVapour(state, air_.interface_height_m, air_.columns);
  if (!vapour.has_value()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      domain_.path, ": ", domain_.vapour_from, " of record ", domain_.record, " gives ", *vapour,
      " kg of vapour per kg of dry air, more than air can hold; if it is in g/kg or %, convert it "
      "or set its units attribute"));
}

// Reads the state of the air, and computes its density on another thread.
absl::StatusOr<std::shared_future<void>> TimeReader::ReadAir() {
  if (!NeedsAir()) return std::async(std::launch::deferred, [] {}).share();
  THUNDERHEAD_ASSIGN_OR_RETURN(LayerState state, source_.Air());
  THUNDERHEAD_RETURN_IF_ERROR(CheckVapour(state));
  // A density in the file is taken as that of the whole air, so it is not increased by condensate.
  std::vector<float> condensate;
  if (NeedsWholeAir() && !state.air_density_kg_per_m3.empty()) {
    condensate.assign(state.air_density_kg_per_m3.size(), 0.0F);
  } else if (NeedsWholeAir()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(condensate, CondensateShare());
  }
  return std::async(std::launch::async,
                    [this, state = std::move(state), condensate = std::move(condensate)]() mutable {
                      if (NeedsTemperature()) air_.temperature_K = Temperature(state);
                      std::vector<float> vapour;
                      if (!condensate.empty()) vapour = state.vapour_kg_per_kg;
                      air_.dry_air_density_kg_per_m3 =
                          DryAirDensity(std::move(state), air_.interface_height_m, air_.columns);
                      if (condensate.empty()) return;
                      air_.whole_air_density_kg_per_m3 =
                          WholeAirDensity(air_.dry_air_density_kg_per_m3, vapour, condensate);
                    })
      .share();
}

const std::vector<float>& TimeReader::DensityFor(const LayerField& field) const {
  static const std::vector<float> kPerVolume;
  if (field.quantity != volume::Quantity::kMixingRatio) return kPerVolume;
  return field.per == AirMass::kWhole ? air_.whole_air_density_kg_per_m3
                                      : air_.dry_air_density_kg_per_m3;
}

absl::StatusOr<RemappedField> TimeReader::Remap(const LayerField& from, LayerAmounts given) const {
  std::vector<float> values = std::move(given.amounts);
  std::vector<float> sizes = std::move(given.sizes);
  if (!sizes.empty()) volume::ToRadius(from.hydrometeor, from.sizes, values, sizes);
  RemappedField remapped;
  volume::HydrometeorField& field = remapped.field;
  field.hydrometeor = from.hydrometeor;
  field.variable = from.variable;
  field.quantity = from.quantity;
  field.sizes = OriginOf(from);
  THUNDERHEAD_RETURN_IF_ERROR(CheckAirOf(from, values));
  field.statistics = AmountToConcentration(air_, DensityFor(from), values);
  if (from.quantity != volume::Quantity::kExtinction && field.statistics.maximum > kMaxAmount) {
    return absl::InvalidArgumentError(
        absl::StrCat(domain_.path, ": ", field.variable, " of record ", domain_.record, " reaches ",
                     field.statistics.maximum, " ", std::string(volume::UnitOf(field.quantity)),
                     ", more than air can hold; if it is in g (g/kg, g m-3), convert it or set its "
                     "units attribute"));
  }
  double factor = 1.0;
  if (field.statistics.maximum_water_path_kg_per_m2 > 0.0) {
    field.concentration_kg_per_m3 = OntoHeights(values);
    factor = columns_.KeepSum(field.concentration_kg_per_m3);
    remapped.condensate = FlushAndBound(regular_, field.concentration_kg_per_m3);
    if (remapped.condensate.Empty()) field.concentration_kg_per_m3 = {};
  }
  if (field.sizes.origin != volume::SizeOrigin::kObserved &&
      !field.concentration_kg_per_m3.empty()) {
    RemapSizes(values, std::move(sizes), factor, field);
  }
  return remapped;
}

// Returns the sizes of a field with only their origin and its name set.
volume::ParticleSizes TimeReader::OriginOf(const LayerField& from) const {
  volume::ParticleSizes sizes;
  if (!from.sizes.name.empty()) {
    sizes.origin =
        from.sizes.is_count ? volume::SizeOrigin::kNumber : volume::SizeOrigin::kEffectiveRadius;
    sizes.name = from.sizes.name;
  } else if (physics::HasDistribution(domain_.microphysics, from.hydrometeor)) {
    sizes.origin = volume::SizeOrigin::kScheme;
    sizes.name = std::string(physics::NameOf(domain_.microphysics));
  }
  return sizes;
}

// Remaps sizes. Extinction is proportional to concentration over radius, so that ratio is remapped,
// and each column keeps its optical depth. `radii` is empty if the file has none. The concentration
// was multiplied by `factor` when its columns were resampled.
void TimeReader::RemapSizes(const std::vector<float>& concentration, std::vector<float> radii,
                            double factor, volume::HydrometeorField& field) const {
  radii.resize(concentration.size(), std::nanf(""));
  volume::ToConcentrationPerRadius(field.hydrometeor, domain_.microphysics, concentration,
                                   air_.temperature_K, radii);
  std::vector<float> per_radius = columns_.Of(OntoHeights(radii), Beyond::kZero);
  if (factor != 1.0) {
    for (float& value : per_radius) value *= static_cast<float>(factor);
  }
  field.sizes = volume::SizesOf(field.sizes, field.concentration_kg_per_m3, per_radius);
}

absl::Status TimeReader::CheckAir() const {
  if (std::ranges::any_of(air_.dry_air_density_kg_per_m3, [](float rho) { return rho > 0.0F; })) {
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat(
      domain_.path, ": pressure, temperature and humidity of record ", domain_.record,
      " give no usable air density in any cell; check their values and units (Pa, K, kg kg-1)"));
}

// Returns an error if a notable share of a field's `amounts` would be lost, because the air of its
// cells is missing or impossible.
absl::Status TimeReader::CheckAirOf(const LayerField& from,
                                    const std::vector<float>& amounts) const {
  constexpr double kNotable = 0.05;
  constexpr double kPercent = 100.0;
  const std::vector<float>& density = DensityFor(from);
  if (density.empty()) return absl::OkStatus();
  const double share = ShareWithoutAir(air_, density, amounts);
  if (!(share > kNotable)) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckAir());
  std::string names = domain_.air_from;
  if (!domain_.vapour_from.empty()) absl::StrAppend(&names, " and ", domain_.vapour_from);
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: %.0f %% of %s of record %d is in cells whose air is missing or impossible, and would be "
      "lost; check the values and units of %s (air has from 100 to 400 K)",
      domain_.path, kPercent * share, from.variable, domain_.record, names));
}

absl::Status TimeReader::ReadFields(volume::HydrometeorFields& result) {
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_future<void> air_ready, ReadAir());
  std::future<absl::StatusOr<RemappedField>> pending;
  const auto take = [&]() -> absl::Status {
    if (!pending.valid()) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(RemappedField remapped, pending.get());
    result.condensate = Union(result.condensate, remapped.condensate);
    result.fields.push_back(std::move(remapped.field));
    return absl::OkStatus();
  };
  for (std::size_t i = 0; i < domain_.fields.size(); ++i) {
    const LayerField& field = domain_.fields[i];
    THUNDERHEAD_RETURN_IF_ERROR(Advance());
    THUNDERHEAD_ASSIGN_OR_RETURN(LayerAmounts amounts, source_.Amounts(i));
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckSize(field.variable, amounts.amounts, air_.levels * air_.columns));
    THUNDERHEAD_RETURN_IF_ERROR(CheckGroundBelow(GroundOfRecord(), ground_m_, amounts.amounts,
                                                 static_cast<std::size_t>(domain_.cells.x)));
    THUNDERHEAD_RETURN_IF_ERROR(take());
    pending = std::async(std::launch::async,
                         [this, air_ready, &field, amounts = std::move(amounts)]() mutable {
                           air_ready.get();
                           return Remap(field, std::move(amounts));
                         });
  }
  THUNDERHEAD_RETURN_IF_ERROR(take());
  if (!NeedsAir()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckAir());
  // All fields get one density: that of the air (dry or whole) to which the first mass ratio
  // refers, even if other mass ratios refer to the other one.
  const auto ratio =
      std::ranges::find(domain_.fields, volume::Quantity::kMixingRatio, &LayerField::quantity);
  result.air = MeanDensity(DensityFor(*ratio));
  return absl::OkStatus();
}

volume::AirDensity TimeReader::MeanDensity(const std::vector<float>& density_kg_per_m3) const {
  volume::AirDensityMeans means(regular_);
  const glm::ivec2 stride = means.Stride();
  for (int y = 0; y < regular_.cells.y; y += stride.y) {
    for (int x = 0; x < regular_.cells.x; x += stride.x) {
      std::size_t at = columns_.NearestTo({x, y});
      for (int level = 0; level < air_.levels; ++level, at += air_.columns) {
        means.Add(x, y, air_.interface_height_m[at], air_.interface_height_m[at + air_.columns],
                  density_kg_per_m3[at]);
      }
    }
  }
  return means.Means();
}

// Returns the values of layers that are the grid's cells, each times the share of its cell that is
// above the ground.
std::vector<float> TimeReader::WithoutBuriedParts(const std::vector<float>& values) const {
  std::vector<float> kept = values;
  const std::vector<float>& height_m = air_.interface_height_m;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (height_m[i] == uncut_m_[i]) continue;
    const std::size_t top = i + air_.columns;
    kept[i] *= (height_m[top] - height_m[i]) / (uncut_m_[top] - uncut_m_[i]);
  }
  return kept;
}

// Returns values, none below 0 and none NaN, at the heights of the regular grid.
std::vector<float> TimeReader::OntoHeights(const std::vector<float>& values) const {
  if (layers_are_cells_ && uncut_m_.empty()) return values;
  if (layers_are_cells_) return WithoutBuriedParts(values);
  return RemapColumns(air_.interface_height_m, values, air_.levels, air_.columns, grid_);
}

// Returns values from 0 to 255 in layers on the regular grid. Missing values become 0.
std::vector<std::uint8_t> TimeReader::BytesOntoGrid(const std::vector<float>& values) const {
  const std::vector<float> remapped = columns_.Of(OntoHeights(values), Beyond::kZero);
  std::vector<std::uint8_t> bytes(remapped.size());
  std::ranges::transform(remapped, bytes.begin(), [](float value) {
    return static_cast<std::uint8_t>(std::min(value + 0.5F, 255.0F));
  });
  return bytes;
}

absl::Status TimeReader::ReadMotion(volume::HydrometeorFields& result) {
  volume::AirMotion& motion = result.motion;
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  THUNDERHEAD_ASSIGN_OR_RETURN(LayerEnergy energy, source_.TurbulentEnergy());
  if (!energy.variable.empty()) {
    motion.source = volume::TurbulenceSource::kEnergy;
    motion.variable = energy.variable;
  }
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  THUNDERHEAD_ASSIGN_OR_RETURN(const ModelWind wind, source_.Wind());
  if (!wind.u_m_per_s.empty()) {
    if (energy.variable.empty() && wind.in_order) {
      energy.energy_m2_per_s2 = EnergyOfDeformation(WindInCells(wind, air_.interface_height_m));
      motion.source = volume::TurbulenceSource::kDeformation;
    }
    TakeWind(wind, result);
  }
  std::vector<float>& turbulence = energy.energy_m2_per_s2;
  if (turbulence.empty()) return absl::OkStatus();
  std::ranges::transform(turbulence, turbulence.begin(), volume::TurbulenceByte);
  motion.turbulence = BytesOntoGrid(turbulence);
  return absl::OkStatus();
}

void TimeReader::TakeWind(const ModelWind& wind, volume::HydrometeorFields& result) const {
  volume::AirMotion& motion = result.motion;
  std::vector<float> ascent =
      wind.on_faces ? LayerMeans(wind.w_m_per_s, air_.levels, air_.columns) : wind.w_m_per_s;
  std::ranges::transform(ascent, ascent.begin(), volume::AscentByte);
  motion.ascent = BytesOntoGrid(ascent);
  std::vector<glm::dvec2> winds = MeanWinds(wind.u_m_per_s, wind.v_m_per_s, wind.cells.z);
  for (glm::dvec2& mean : winds) mean = AlongAxes(wind, mean);
  std::vector<double> height_m = LevelMeans(air_.interface_height_m, air_.levels + 1);
  std::vector<double> first_column_m;
  for (std::size_t i = 0; i < air_.interface_height_m.size(); i += air_.columns) {
    first_column_m.push_back(air_.interface_height_m[i]);
  }
  const auto is_missing = [](double each_m) { return std::isnan(each_m); };
  if (std::ranges::any_of(first_column_m, is_missing)) first_column_m = height_m;
  // Levels that lie below the ground everywhere have no heights.
  const auto first = std::ranges::find_if_not(height_m, is_missing);
  const auto below = std::min(first - height_m.begin(), std::ssize(winds));
  winds.erase(winds.begin(), winds.begin() + below);
  height_m.erase(height_m.begin(), height_m.begin() + below);
  first_column_m.erase(first_column_m.begin(), first_column_m.begin() + below);
  if (winds.empty()) return;
  motion.steering_m_per_s = SteeringWind_m_per_s(winds, height_m);
  motion.time_s = absl::ToDoubleSeconds(domain_.time - absl::UnixEpoch());
  motion.shear_m_per_s = Shear_m_per_s(result, winds, first_column_m);
}

// Returns a mean wind along the axes of the regular grid.
glm::dvec2 TimeReader::AlongAxes(const ModelWind& wind, const glm::dvec2& mean_m_per_s) const {
  if (domain_.even == nullptr) return mean_m_per_s;
  return wind.east_and_north ? EastNorthAlongEvenAxes(*domain_.even, mean_m_per_s)
                             : AlongEvenAxes(*domain_.even, mean_m_per_s);
}

// Removes those cells above the storm's grid that hold no condensate.
void TrimTop(const VerticalGrid& storm_grid, volume::HydrometeorFields& fields) {
  volume::RegularGrid& grid = fields.grid;
  const double storm_top = (storm_grid.High_m() - grid.low_corner_m.z) / grid.spacing_m.z;
  const int cells = std::max(static_cast<int>(std::lround(storm_top)), fields.condensate.high.z);
  if (cells >= grid.cells.z) return;
  grid.cells.z = cells;
  for (std::vector<std::uint8_t>* values : {&fields.motion.turbulence, &fields.motion.ascent}) {
    if (!values->empty()) values->resize(grid.CellCount());
  }
  if (!fields.air.Empty()) {
    const auto blocks = static_cast<std::size_t>(fields.air.blocks.x * fields.air.blocks.y);
    fields.air.kg_per_m3.resize(blocks * static_cast<std::size_t>(cells));
  }
  for (volume::HydrometeorField& field : fields.fields) {
    if (field.concentration_kg_per_m3.empty()) continue;
    field.concentration_kg_per_m3.resize(grid.CellCount());
    field.concentration_kg_per_m3.shrink_to_fit();
  }
}

void TimeReader::SetGrid() {
  regular_.cells = {columns_.Columns(), grid_.cells};
  regular_.spacing_m = {columns_.Spacing_m(), grid_.spacing_m};
  regular_.low_corner_m = {columns_.LowCorner_m(), grid_.low_m};
}

absl::StatusOr<volume::HydrometeorFields> TimeReader::Read(const std::optional<VerticalGrid>& grid,
                                                           const ReadCheckpoint& checkpoint) {
  checkpoint_ = checkpoint;
  THUNDERHEAD_RETURN_IF_ERROR(ReadHeights().status());
  THUNDERHEAD_ASSIGN_OR_RETURN(grid_, GridFor(grid));
  layers_are_cells_ = LayersAreCells(air_.interface_height_m, air_.levels, air_.columns, grid_);
  THUNDERHEAD_RETURN_IF_ERROR(CutLayersAtGround());
  SetGrid();
  volume::HydrometeorFields result;
  result.grid = regular_;
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  TakeTerrain(result);
  THUNDERHEAD_RETURN_IF_ERROR(ReadLand(result));
  THUNDERHEAD_RETURN_IF_ERROR(ReadFields(result));
  THUNDERHEAD_RETURN_IF_ERROR(ReadMotion(result));
  if (grid.has_value()) TrimTop(*grid, result);
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  return result;
}

// Runs `read` on a reader of the source. Running out of memory counts as an error of the input,
// because it must not end the server.
template <typename Result, typename ReadFunction>
absl::StatusOr<Result> WithReader(LayerSource& source, int stride, ReadFunction read) {
  const LayerDomain& domain = source.Domain();
  try {
    TimeReader reader(source, stride);
    return read(reader);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return absl::ResourceExhaustedError(
      absl::StrCat(domain.path, ": one time of ", domain.cells.x, " x ", domain.cells.y, " x ",
                   domain.cells.z, " cells does not fit in memory; cut a smaller domain"));
}

}  // namespace

absl::StatusOr<volume::HydrometeorFields> ReadOnHeights(LayerSource& source, const RecordPart& part,
                                                        const std::optional<VerticalGrid>& grid,
                                                        const ReadCheckpoint& checkpoint) {
  const LayerDomain& domain = source.Domain();
  THUNDERHEAD_RETURN_IF_ERROR(CheckPart(domain.path, part, domain.StormColumns()));
  std::unique_ptr<LayerSource> windowed;
  if (part.window.has_value()) windowed = MakeWindowedSource(source, *part.window);
  return WithReader<volume::HydrometeorFields>(
      windowed != nullptr ? *windowed : source, part.stride,
      [&](TimeReader& reader) { return reader.Read(grid, checkpoint); });
}

absl::StatusOr<VerticalGrid> HeightGridOf(LayerSource& source) {
  return WithReader<VerticalGrid>(source, 1,
                                  [](TimeReader& reader) { return reader.ReadHeights(); });
}

namespace {

class LayerRecordReader final : public RecordReader {
 public:
  explicit LayerRecordReader(OpenRecord open) : open_(std::move(open)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(const RecordPart& part,
                                                 const std::optional<VerticalGrid>& grid,
                                                 const ReadCheckpoint& checkpoint) const override {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<LayerSource> source, open_(part.record));
    return ReadOnHeights(*source, part, grid, checkpoint);
  }

  absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t record) const override {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<LayerSource> source, open_(record));
    return HeightGridOf(*source);
  }

 private:
  const OpenRecord open_;
};

}  // namespace

std::shared_ptr<const RecordReader> MakeRecordReader(OpenRecord open) {
  return std::make_shared<LayerRecordReader>(std::move(open));
}

}  // namespace thunderhead::storm_files
