#include "storm_files/grib_source.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "grib/decompressed.h"
#include "grib/values.h"
#include "storm_files/grib_air.h"
#include "storm_files/grib_columns.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using Values = std::vector<float>;

bool IsAnyFinite(const Values& values) {
  return std::ranges::any_of(values, [](float value) { return std::isfinite(value); });
}

// Decodes fields of a storm's files.
class Decoder {
 public:
  explicit Decoder(const GribStorm& storm) : storm_(storm) {}

  // Returns the values of a field, x fastest from west to east, then y from south to north. Safe to
  // call from several threads.
  absl::StatusOr<Values> Read(const GribPlace& place) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<const base::ByteSource> file,
                                 Open(place.file));
    THUNDERHEAD_ASSIGN_OR_RETURN(Values values, grib::DecodeValues(*file, *place.field));
    return grib::Arranged(storm_.contents.grid, std::move(values));
  }

  // Returns the values of all levels, in the series' order or from its end. A level without the
  // field gets NaN.
  absl::StatusOr<Values> Read(const GribSeries& series, bool from_end);

 private:
  // A single file stays open, because it holds all fields. If there are several files, each holds
  // few fields and is opened when needed.
  absl::StatusOr<std::shared_ptr<const base::ByteSource>> Open(std::size_t file) {
    if (storm_.files.size() > 1) return OpenPlain(storm_.files[file]);
    const std::lock_guard lock(mutex_);
    if (only_file_ == nullptr) {
      THUNDERHEAD_ASSIGN_OR_RETURN(only_file_, OpenPlain(storm_.files[0]));
    }
    return only_file_;
  }

  static absl::StatusOr<std::shared_ptr<const base::ByteSource>> OpenPlain(const GribInput& input) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<const base::ByteSource> file, input.open());
    return grib::Decompressed(std::move(file));
  }

  const GribStorm& storm_;
  std::mutex mutex_;
  std::shared_ptr<const base::ByteSource> only_file_;
};

absl::StatusOr<Values> Decoder::Read(const GribSeries& series, bool from_end) {
  const std::size_t columns = storm_.contents.grid.Points();
  const std::size_t levels = series.levels.size();
  THUNDERHEAD_RETURN_IF_ERROR(
      base::CountThatFits(absl::StrCat(storm_.contents.path, ": ", series.name), {columns, levels},
                          sizeof(float))
          .status());
  Values all(columns * levels, std::nanf(""));
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&]() -> absl::Status {
    for (std::size_t level = next++; level < levels && !failed; level = next++) {
      const GribPlace& place = series.levels[from_end ? levels - 1 - level : level];
      if (place.field == nullptr) continue;
      auto values = Read(place);
      if (!values.ok()) {
        failed = true;
        return values.status();
      }
      std::ranges::copy(*values, all.begin() + static_cast<std::ptrdiff_t>(level * columns));
    }
    return absl::OkStatus();
  };
  // Each thread needs memory for one decoded field.
  constexpr std::size_t kMostThreads = 8;
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1,
                                                      std::min(kMostThreads, levels));
  std::vector<std::future<absl::Status>> others;
  for (std::size_t i = 1; i < threads; ++i) {
    others.push_back(std::async(std::launch::async, work));
  }
  absl::Status status = work();
  for (std::future<absl::Status>& other : others) {
    absl::Status result = other.get();
    if (status.ok()) status = std::move(result);
  }
  if (!status.ok()) return status;
  return all;
}

class GribSource final : public LayerSource {
 public:
  GribSource(std::shared_ptr<const GribStorm> storm, std::size_t record);

  // Finds out whether levels are numbered downwards.
  absl::Status Prepare();

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<Values> InterfaceHeights_m() override;
  absl::StatusOr<LayerState> Air() override;
  absl::StatusOr<LayerAmounts> Amounts(std::size_t field) override;
  absl::StatusOr<Values> Terrain_m() override;
  absl::StatusOr<volume::LandColumns> Land() override;
  absl::StatusOr<LayerEnergy> TurbulentEnergy() override;
  absl::StatusOr<ModelWind> Wind() override;

 private:
  std::size_t Columns() const { return storm_->contents.grid.Points(); }
  absl::StatusOr<Values> Read(const GribSeries& series);
  absl::StatusOr<Values> Pressure();
  absl::StatusOr<Values> InterfacePressure();
  absl::StatusOr<Values> SurfacePressure();
  absl::StatusOr<Values> LevelHeights();
  absl::StatusOr<Values> Vapour(const Values& pressure_Pa, const Values& temperature_K);
  // Returns the temperatures, with NaN in place of impossible ones.
  absl::StatusOr<Values> Temperature_K();
  absl::StatusOr<Values> VirtualTemperature();
  absl::StatusOr<Values> IsobaricInterfaces();
  absl::StatusOr<Values> Ascent();
  absl::Status AlongGrid(ModelWind& wind) const;
  absl::Status CheckLowest() const;

  const std::shared_ptr<const GribStorm> storm_;
  const GribLayers& layers_;
  Decoder decoder_;
  LayerDomain domain_;
  bool downwards_ = false;  // true if the first of the series' levels is the highest
};

GribSource::GribSource(std::shared_ptr<const GribStorm> storm, std::size_t record)
    : storm_(std::move(storm)), layers_(storm_->contents.times[record]), decoder_(*storm_) {
  const GribContents& contents = storm_->contents;
  domain_.path = contents.path;
  domain_.record = record;
  domain_.time = layers_.time;
  domain_.cells = {contents.grid.columns, contents.grid.rows,
                   static_cast<int>(layers_.levels.size())};
  domain_.even = storm_->even;
  domain_.dx_m = domain_.even->ModelSpacing_m().x;
  domain_.dy_m = domain_.even->ModelSpacing_m().y;
  domain_.on_terrain =
      layers_.vertical == GribVertical::kHalfHeights || !layers_.surface_height.Empty();
  domain_.ground_from = layers_.surface_height.name;
  domain_.air_from = layers_.temperature.name;
  domain_.vapour_from = layers_.humidity.name;
  domain_.microphysics = contents.model.microphysics;
  for (const GribHydrometeor& hydrometeor : layers_.hydrometeors) {
    LayerField field;
    field.hydrometeor = hydrometeor.hydrometeor;
    field.variable = hydrometeor.amounts.name;
    field.quantity = hydrometeor.quantity;
    field.per = hydrometeor.per;
    if (!hydrometeor.numbers.Empty()) field.sizes = {hydrometeor.numbers.name, true};
    domain_.fields.push_back(std::move(field));
  }
}

absl::Status GribSource::Prepare() {
  if (layers_.vertical == GribVertical::kIsobaric) return absl::OkStatus();
  if (layers_.vertical == GribVertical::kHydrostatic) {
    downwards_ = true;
    return absl::OkStatus();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values first, decoder_.Read(layers_.heights.levels.front()));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values last, decoder_.Read(layers_.heights.levels.back()));
  for (std::size_t column = 0; column < first.size(); ++column) {
    const float rise = last[column] - first[column];
    if (!std::isfinite(rise) || rise == 0.0F) continue;
    downwards_ = rise < 0.0F;
    return CheckLowest();
  }
  return absl::DataLossError(
      absl::StrCat(domain_.path, ": ", layers_.heights.name,
                   " gives the same or no height on all levels; get the file "
                   "again"));
}

// Checks that the lowest level is there. Levels that count upwards begin with 1 at the ground.
absl::Status GribSource::CheckLowest() const {
  if (downwards_ || layers_.levels.front() == 1.0) return absl::OkStatus();
  return absl::DataLossError(
      absl::StrCat(domain_.path, ": every field of the levels below level ", layers_.levels.front(),
                   " is missing, which are the lowest; get the complete set of fields"));
}

absl::StatusOr<Values> GribSource::Read(const GribSeries& series) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Values values, decoder_.Read(series, downwards_));
  if (IsAnyFinite(values)) return values;
  return absl::DataLossError(absl::StrCat(domain_.path, ": ", series.name, " of record ",
                                          domain_.record,
                                          " has no value at any point; get the file "
                                          "again"));
}

absl::StatusOr<Values> GribSource::Terrain_m() {
  if (layers_.surface_height.Empty()) return Values();
  THUNDERHEAD_ASSIGN_OR_RETURN(Values ground_m, decoder_.Read(layers_.surface_height.levels[0]));
  if (layers_.surface_height.kind == GribKind::kGeopotential) {
    for (float& height : ground_m) height /= static_cast<float>(kStandardGravity_m_per_s2);
  }
  return ground_m;
}

absl::StatusOr<volume::LandColumns> GribSource::Land() {
  volume::LandColumns columns;
  if (layers_.land_use.Empty()) return columns;
  columns.scheme = physics::LandUseScheme::kModis;
  const auto read = [this](const GribSeries& series, float scale, Values& values) -> absl::Status {
    if (series.Empty()) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(values, decoder_.Read(series.levels[0]));
    for (float& value : values) value *= scale;
    return absl::OkStatus();
  };
  constexpr float kPercent = 0.01F;
  THUNDERHEAD_RETURN_IF_ERROR(read(layers_.land_use, 1.0F, columns.land_use));
  THUNDERHEAD_RETURN_IF_ERROR(read(layers_.land_share, 1.0F, columns.water));
  for (float& share : columns.water) share = 1.0F - share;
  THUNDERHEAD_RETURN_IF_ERROR(read(layers_.albedo, kPercent, columns.albedo));
  THUNDERHEAD_RETURN_IF_ERROR(read(layers_.green_cover, 1.0F, columns.green_percent));
  THUNDERHEAD_RETURN_IF_ERROR(read(layers_.snow_cover, kPercent, columns.snow_share));
  return columns;
}

absl::StatusOr<Values> GribSource::SurfacePressure() {
  if (layers_.surface_pressure.Empty()) return Values();
  THUNDERHEAD_ASSIGN_OR_RETURN(Values pressure_Pa,
                               decoder_.Read(layers_.surface_pressure.levels[0]));
  if (layers_.surface_pressure.kind == GribKind::kLogPressure) {
    for (float& value : pressure_Pa) value = std::exp(value);
  }
  return pressure_Pa;
}

absl::StatusOr<Values> GribSource::InterfacePressure() {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values surface_Pa, SurfacePressure());
  return HybridPressures(layers_.half_level_coefficients, layers_.levels.size(), surface_Pa);
}

// Returns the pressure of every level.
absl::StatusOr<Values> GribSource::Pressure() {
  if (layers_.vertical == GribVertical::kIsobaric) {
    Values pressure_Pa;
    for (const double level_Pa : layers_.levels) {
      pressure_Pa.insert(pressure_Pa.end(), Columns(), static_cast<float>(level_Pa));
    }
    return pressure_Pa;
  }
  if (layers_.vertical != GribVertical::kHydrostatic) return Read(layers_.pressure);
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values interfaces_Pa, InterfacePressure());
  return LayerMeans(interfaces_Pa, static_cast<int>(layers_.levels.size()), Columns());
}

// Returns the vapour per kg of dry air, or an empty array if the file has no humidity.
absl::StatusOr<Values> GribSource::Vapour(const Values& pressure_Pa, const Values& temperature_K) {
  if (layers_.humidity.Empty()) return Values();
  THUNDERHEAD_ASSIGN_OR_RETURN(Values vapour, Read(layers_.humidity));
  if (layers_.humidity.kind == GribKind::kSpecificHumidity) SpecificHumidityToVapour(vapour);
  if (layers_.humidity.kind == GribKind::kRelativeHumidity) {
    RelativeHumidityToVapour(pressure_Pa, temperature_K, vapour);
  }
  return vapour;
}

absl::StatusOr<Values> GribSource::Temperature_K() {
  THUNDERHEAD_ASSIGN_OR_RETURN(Values temperature_K, Read(layers_.temperature));
  LeaveOutImpossibleTemperatures(temperature_K);
  return temperature_K;
}

absl::StatusOr<LayerState> GribSource::Air() {
  LayerState state;
  THUNDERHEAD_ASSIGN_OR_RETURN(state.pressure_Pa, Pressure());
  THUNDERHEAD_ASSIGN_OR_RETURN(state.temperature_K, Temperature_K());
  THUNDERHEAD_ASSIGN_OR_RETURN(state.vapour_kg_per_kg,
                               Vapour(state.pressure_Pa, state.temperature_K));
  return state;
}

absl::StatusOr<Values> GribSource::VirtualTemperature() {
  THUNDERHEAD_ASSIGN_OR_RETURN(const LayerState state, Air());
  return VirtualTemperature_K(state.temperature_K, state.vapour_kg_per_kg);
}

absl::StatusOr<Values> GribSource::LevelHeights() {
  THUNDERHEAD_ASSIGN_OR_RETURN(Values heights_m, Read(layers_.heights));
  if (layers_.heights.kind == GribKind::kGeopotential) {
    for (float& height : heights_m) height /= static_cast<float>(kStandardGravity_m_per_s2);
  }
  return heights_m;
}

absl::StatusOr<Values> GribSource::IsobaricInterfaces() {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values ground_m, Terrain_m());
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values surface_Pa, SurfacePressure());
  Values heights_m(Columns() * layers_.levels.size(), std::nanf(""));
  std::vector<bool> has_height(layers_.levels.size(), false);
  if (!layers_.heights.Empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(heights_m, LevelHeights());
    for (std::size_t i = 0; i < has_height.size(); ++i) {
      has_height[i] = layers_.heights.levels[i].field != nullptr;
    }
  }
  if (std::ranges::find(has_height, false) != has_height.end()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const Values virtual_K, VirtualTemperature());
    FillHeights(layers_.levels, virtual_K, has_height, surface_Pa, ground_m, heights_m);
  }
  Values interfaces_m = InterfacesBetween(heights_m, ground_m, domain_.cells.z, Columns());
  CutAtGround(layers_.levels, heights_m, surface_Pa, ground_m, interfaces_m);
  return interfaces_m;
}

absl::StatusOr<Values> GribSource::InterfaceHeights_m() {
  switch (layers_.vertical) {
    case GribVertical::kHalfHeights:
      return LevelHeights();
    case GribVertical::kHeights: {
      THUNDERHEAD_ASSIGN_OR_RETURN(const Values heights_m, LevelHeights());
      THUNDERHEAD_ASSIGN_OR_RETURN(const Values ground_m, Terrain_m());
      return InterfacesBetween(heights_m, ground_m, domain_.cells.z, Columns());
    }
    case GribVertical::kHydrostatic: {
      THUNDERHEAD_ASSIGN_OR_RETURN(const Values virtual_K, VirtualTemperature());
      THUNDERHEAD_ASSIGN_OR_RETURN(const Values interfaces_Pa, InterfacePressure());
      THUNDERHEAD_ASSIGN_OR_RETURN(const Values ground_m, Terrain_m());
      return HydrostaticInterfaces(interfaces_Pa, virtual_K, ground_m);
    }
    case GribVertical::kIsobaric:
      return IsobaricInterfaces();
  }
  return absl::InternalError("there is no other kind of levels");
}

absl::StatusOr<LayerAmounts> GribSource::Amounts(std::size_t field) {
  const GribHydrometeor& hydrometeor = layers_.hydrometeors[field];
  LayerAmounts amounts;
  THUNDERHEAD_ASSIGN_OR_RETURN(amounts.amounts, Read(hydrometeor.amounts));
  if (!hydrometeor.numbers.Empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(amounts.sizes, Read(hydrometeor.numbers));
  }
  if (!hydrometeor.is_split) return amounts;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values temperature_K, Temperature_K());
  for (std::size_t i = 0; i < temperature_K.size(); ++i) {
    const float ice = IceShare(temperature_K[i]);
    amounts.amounts[i] *= hydrometeor.hydrometeor == Hydrometeor::kIce ? ice : 1.0F - ice;
  }
  return amounts;
}

absl::StatusOr<LayerEnergy> GribSource::TurbulentEnergy() {
  LayerEnergy energy;
  if (layers_.energy.Empty()) return energy;
  energy.variable = layers_.energy.name;
  THUNDERHEAD_ASSIGN_OR_RETURN(energy.energy_m2_per_s2, Read(layers_.energy));
  if (layers_.energy.on_half_levels) {
    energy.energy_m2_per_s2 =
        LayerMeans(energy.energy_m2_per_s2, static_cast<int>(layers_.levels.size()), Columns());
  }
  return energy;
}

absl::StatusOr<Values> GribSource::Ascent() {
  THUNDERHEAD_ASSIGN_OR_RETURN(Values ascent, Read(layers_.ascent));
  if (layers_.ascent.on_half_levels) {
    return LayerMeans(ascent, static_cast<int>(layers_.levels.size()), Columns());
  }
  if (layers_.ascent.kind == GribKind::kAscent) return ascent;
  THUNDERHEAD_ASSIGN_OR_RETURN(const LayerState state, Air());
  OmegaToAscent(state.pressure_Pa,
                VirtualTemperature_K(state.temperature_K, state.vapour_kg_per_kg), ascent);
  return ascent;
}

absl::StatusOr<ModelWind> GribSource::Wind() {
  ModelWind wind;
  if (!layers_.HasWind()) return wind;
  wind.cells = domain_.cells;
  wind.dx_m = domain_.dx_m;
  wind.dy_m = domain_.dy_m;
  wind.on_faces = false;
  wind.in_order = !storm_->contents.grid.IsUnstructured();
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.u_m_per_s, Read(layers_.wind_x));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.v_m_per_s, Read(layers_.wind_y));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.w_m_per_s, Ascent());
  const grib::Grid& grid = storm_->contents.grid;
  wind.east_and_north = grid.IsUnstructured();
  if (grid.wind_along_grid || grid.IsUnstructured()) return wind;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Values angles, AxisAngles(grid));
  for (std::size_t i = 0; i < wind.u_m_per_s.size() && !angles.empty(); ++i) {
    const float angle = angles[i % angles.size()];
    const float east = wind.u_m_per_s[i];
    const float north = wind.v_m_per_s[i];
    wind.u_m_per_s[i] = east * std::cos(angle) + north * std::sin(angle);
    wind.v_m_per_s[i] = north * std::cos(angle) - east * std::sin(angle);
  }
  return wind;
}

}  // namespace

absl::StatusOr<std::vector<float>> ReadGribField(const GribStorm& storm, const GribPlace& place) {
  return Decoder(storm).Read(place);
}

absl::StatusOr<std::unique_ptr<LayerSource>> OpenGribTime(std::shared_ptr<const GribStorm> storm,
                                                          std::size_t record) {
  auto source = std::make_unique<GribSource>(std::move(storm), record);
  THUNDERHEAD_RETURN_IF_ERROR(source->Prepare());
  return source;
}

}  // namespace thunderhead::storm_files
