#include "storm_files/wrf_reader.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/field_scan.h"
#include "storm_files/layer_air.h"
#include "storm_files/wind_motion.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

constexpr float kBaseTheta_K = 300.0F;  // WRF's variable T is the potential temperature minus this
                                        // value

// The largest mixing ratio in kg/kg that is accepted. Air never carries half its mass in
// condensate, so larger values are in g/kg.
constexpr float kMaxMixingRatio = 0.5F;

// Snow of this depth hides short plants.
constexpr float kCoveringSnow_m = 0.1F;

struct RemappedField {
  volume::HydrometeorField field;
  volume::CellBox condensate;
  std::vector<float> buffer;  // returned for the next variable to reuse
};

// Reads one record. Variables are read on the calling thread, one at a time. At the same time
// another thread remaps the previous variable, because reading and remapping take about equally
// long.
class TimeReader {
 public:
  TimeReader(const WrfMetadata& metadata, std::size_t record, netcdf::NetcdfFile file)
      : metadata_(metadata), record_(record), file_(std::move(file)) {
    air_.levels = metadata.cells.z;
    air_.columns = static_cast<std::size_t>(metadata.cells.x) * metadata.cells.y;
  }

  absl::StatusOr<VerticalGrid> ReadHeights();
  absl::StatusOr<volume::HydrometeorFields> Read(const std::optional<VerticalGrid>& grid,
                                                 const ReadCheckpoint& checkpoint);

 private:
  absl::Status ReadVariable(const std::string& variable, std::size_t cells,
                            std::vector<float>& values);
  absl::Status ReadSum(const std::string& perturbation, const std::string& base, std::size_t cells,
                       std::vector<float>& sum, std::vector<float>& base_values);
  absl::StatusOr<LayerState> ReadState();
  absl::Status ReadTerrain(volume::HydrometeorFields& result);
  absl::Status ReadLand(volume::HydrometeorFields& result);
  absl::Status ReadFields(volume::HydrometeorFields& result);
  volume::AirDensity MeanDensity() const;
  absl::Status ReadMotion(volume::HydrometeorFields& result);
  absl::StatusOr<StaggeredWind> ReadWind();
  absl::StatusOr<std::vector<float>> ReadEnergy();
  std::vector<std::uint8_t> RemapBytes(const std::vector<float>& values) const;
  absl::StatusOr<VerticalGrid> GridFor(const std::optional<VerticalGrid>& storm_grid) const;
  absl::StatusOr<RemappedField> Remap(Hydrometeor hydrometeor, std::vector<float> values,
                                      std::vector<float> sizes) const;
  volume::ParticleSizes OriginOf(Hydrometeor hydrometeor) const;
  void RemapSizes(const std::vector<float>& concentration, std::vector<float> radii,
                  volume::HydrometeorField& field) const;
  absl::Status Take(std::future<absl::StatusOr<RemappedField>>& pending,
                    volume::HydrometeorFields& result);
  absl::Status Advance();
  bool NeedsTemperature() const;

  const WrfMetadata& metadata_;
  std::size_t record_;
  netcdf::NetcdfFile file_;
  LayerAir air_;
  VerticalGrid own_grid_;
  VerticalGrid grid_;
  volume::RegularGrid regular_;
  std::vector<float> buffer_;
  ReadCheckpoint checkpoint_;
  int variables_read_ = 0;
};

absl::Status TimeReader::Advance() {
  if (!checkpoint_) return absl::OkStatus();
  const auto sizes = std::ranges::count_if(
      metadata_.sizes, [](const volume::SizeVariable& size) { return !size.name.empty(); });
  const int variables = 5 + (metadata_.has_vapour ? 1 : 0) +
                        static_cast<int>(metadata_.fields.size()) + static_cast<int>(sizes) +
                        (metadata_.energy.name.empty() ? 0 : 1) + (metadata_.has_wind ? 3 : 0);
  return checkpoint_(std::min(1.0, static_cast<double>(variables_read_++) / variables));
}

absl::Status TimeReader::ReadVariable(const std::string& variable, std::size_t cells,
                                      std::vector<float>& values) {
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  // The length is checked before memory is allocated for it.
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::size_t length, file_.RecordLength(variable));
  if (length != cells) {
    return absl::DataLossError(absl::StrCat(file_.Path(), ": ", variable, " now has ", length,
                                            " values a time where it had ", cells,
                                            "; the file was replaced: restart to read it anew"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(file_.ReadRecord(variable, record_, values));
  if (std::ranges::all_of(values, [](float value) { return std::isnan(value); })) {
    return absl::DataLossError(absl::StrCat(
        file_.Path(), ": ", variable, " of record ", record_, " holds nothing but fill values; ",
        "the model may still be writing the file: try again when it has finished"));
  }
  return absl::OkStatus();
}

absl::Status TimeReader::ReadSum(const std::string& perturbation, const std::string& base,
                                 std::size_t cells, std::vector<float>& sum,
                                 std::vector<float>& base_values) {
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(perturbation, cells, sum));
  return ReadVariable(base, cells, base_values);
}

absl::StatusOr<VerticalGrid> TimeReader::ReadHeights() {
  const std::size_t cells = (air_.levels + 1) * air_.columns;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSum("PH", "PHB", cells, air_.interface_height_m, buffer_));
  GeopotentialToHeight(buffer_, air_.interface_height_m);
  own_grid_ = ChooseVerticalGrid(air_.interface_height_m, air_.levels, air_.columns);
  if (own_grid_.cells == 0) {
    return absl::DataLossError(
        absl::StrCat(file_.Path(), ": PH + PHB of record ", record_,
                     " give no layer whose top is above its bottom; write the file again"));
  }
  return own_grid_;
}

absl::StatusOr<LayerState> TimeReader::ReadState() {
  const std::size_t cells = air_.levels * air_.columns;
  LayerState state;
  THUNDERHEAD_RETURN_IF_ERROR(ReadSum("P", "PB", cells, state.pressure_Pa, buffer_));
  for (std::size_t i = 0; i < cells; ++i) state.pressure_Pa[i] += buffer_[i];
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable("T", cells, state.potential_temperature_K));
  for (float& theta_K : state.potential_temperature_K) theta_K += kBaseTheta_K;
  if (metadata_.has_vapour) {
    THUNDERHEAD_RETURN_IF_ERROR(ReadVariable("QVAPOR", cells, state.vapour_kg_per_kg));
  }
  return state;
}

// Reads the terrain. Where the height is missing, the bottom of the lowest layer replaces it.
absl::Status TimeReader::ReadTerrain(volume::HydrometeorFields& result) {
  std::vector<float>& terrain = result.terrain_height_m;
  terrain.assign(air_.columns, std::nanf(""));
  if (metadata_.has_terrain) {
    THUNDERHEAD_RETURN_IF_ERROR(file_.ReadRecord("HGT", record_, terrain));
    terrain.resize(air_.columns, std::nanf(""));
  }
  for (std::size_t i = 0; i < air_.columns; ++i) {
    if (std::isnan(terrain[i])) terrain[i] = air_.interface_height_m[i];
    if (std::isnan(terrain[i])) terrain[i] = static_cast<float>(grid_.low_m);
  }
  return absl::OkStatus();
}

// Reads the land cover for this record, because snow cover changes with time.
absl::Status TimeReader::ReadLand(volume::HydrometeorFields& result) {
  const WrfLand& names = metadata_.land;
  if (names.land_use.empty()) return absl::OkStatus();
  volume::LandColumns columns;
  columns.scheme = names.scheme;
  const auto read = [&](const std::string& name, std::vector<float>& values) -> absl::Status {
    if (name.empty()) return absl::OkStatus();
    THUNDERHEAD_RETURN_IF_ERROR(file_.ReadRecord(name, record_, values));
    values.resize(air_.columns, std::nanf(""));
    return absl::OkStatus();
  };
  THUNDERHEAD_RETURN_IF_ERROR(read(names.land_use, columns.land_use));
  THUNDERHEAD_RETURN_IF_ERROR(read(names.mask, columns.water));
  THUNDERHEAD_RETURN_IF_ERROR(read(names.albedo, columns.albedo));
  THUNDERHEAD_RETURN_IF_ERROR(read(names.green, columns.green_percent));
  THUNDERHEAD_RETURN_IF_ERROR(read(names.snow_share, columns.snow_share));
  THUNDERHEAD_RETURN_IF_ERROR(read(names.snow_depth, columns.snow_share));
  for (float& water : columns.water) water = names.mask == "XLAND" ? water - 1.0F : 1.0F - water;
  if (!names.snow_depth.empty()) {
    for (float& snow : columns.snow_share) snow /= kCoveringSnow_m;
  }
  result.land = volume::MakeLandSurface(columns, glm::ivec2(metadata_.cells));
  return absl::OkStatus();
}

absl::StatusOr<VerticalGrid> TimeReader::GridFor(
    const std::optional<VerticalGrid>& storm_grid) const {
  if (!storm_grid.has_value()) return own_grid_;
  const VerticalGrid grid = Extended(*storm_grid, air_.interface_height_m);
  constexpr int kFewCells = 8;
  if (grid.cells <= 2 * storm_grid->cells + kFewCells) return grid;
  return absl::DataLossError(absl::StrCat(
      file_.Path(), ": the heights of record ", record_, " (PH + PHB) reach from ", grid.low_m,
      " to ", grid.High_m(), " m where the storm's first time has ", storm_grid->low_m, " to ",
      storm_grid->High_m(), " m; give files of one run only"));
}

absl::StatusOr<RemappedField> TimeReader::Remap(Hydrometeor hydrometeor, std::vector<float> values,
                                                std::vector<float> sizes) const {
  if (!sizes.empty()) {
    volume::ToRadius(hydrometeor, metadata_.sizes[physics::IndexOf(hydrometeor)], values, sizes);
  }
  RemappedField remapped;
  volume::HydrometeorField& field = remapped.field;
  field.hydrometeor = hydrometeor;
  field.variable = std::string(WrfVariableOf(hydrometeor));
  field.sizes = OriginOf(hydrometeor);
  field.statistics = MixingRatioToConcentration(air_, values);
  if (field.statistics.maximum > kMaxMixingRatio) {
    return absl::InvalidArgumentError(
        absl::StrCat(file_.Path(), ": ", field.variable, " of record ", record_, " reaches ",
                     field.statistics.maximum,
                     " where kg of water per kg of air is needed; if it is in g/kg, divide it by "
                     "1000 and set its units attribute"));
  }
  if (field.statistics.maximum_water_path_kg_per_m2 > 0.0) {
    field.concentration_kg_per_m3 =
        RemapColumns(air_.interface_height_m, values, air_.levels, air_.columns, grid_);
    remapped.condensate = FlushAndBound(regular_, field.concentration_kg_per_m3);
    if (remapped.condensate.Empty()) field.concentration_kg_per_m3 = {};
  }
  if (field.sizes.origin != volume::SizeOrigin::kObserved &&
      !field.concentration_kg_per_m3.empty()) {
    RemapSizes(values, std::move(sizes), field);
  }
  remapped.buffer = std::move(values);
  return remapped;
}

// Returns the sizes of a field with only their origin and its name set.
volume::ParticleSizes TimeReader::OriginOf(Hydrometeor hydrometeor) const {
  volume::ParticleSizes sizes;
  const volume::SizeVariable& variable = metadata_.sizes[physics::IndexOf(hydrometeor)];
  if (!variable.name.empty()) {
    sizes.origin =
        variable.is_count ? volume::SizeOrigin::kNumber : volume::SizeOrigin::kEffectiveRadius;
    sizes.name = variable.name;
  } else if (physics::HasDistribution(metadata_.microphysics, hydrometeor)) {
    sizes.origin = volume::SizeOrigin::kScheme;
    sizes.name = std::string(physics::NameOf(metadata_.microphysics));
  }
  return sizes;
}

// Remaps sizes. Extinction is proportional to concentration over radius, so that ratio is remapped,
// and each column keeps its optical depth. `radii` is empty if the file has none.
void TimeReader::RemapSizes(const std::vector<float>& concentration, std::vector<float> radii,
                            volume::HydrometeorField& field) const {
  radii.resize(concentration.size(), std::nanf(""));
  volume::ToConcentrationPerRadius(field.hydrometeor, metadata_.microphysics, concentration,
                                   air_.temperature_K, radii);
  field.sizes = volume::SizesOf(
      field.sizes, field.concentration_kg_per_m3,
      RemapColumns(air_.interface_height_m, radii, air_.levels, air_.columns, grid_));
}

absl::Status TimeReader::Take(std::future<absl::StatusOr<RemappedField>>& pending,
                              volume::HydrometeorFields& result) {
  if (!pending.valid()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(RemappedField remapped, pending.get());
  buffer_ = std::move(remapped.buffer);
  result.condensate = Union(result.condensate, remapped.condensate);
  result.fields.push_back(std::move(remapped.field));
  return absl::OkStatus();
}

// Returns whether the sizes of snow come from the scheme's distribution, which depends on
// temperature.
bool TimeReader::NeedsTemperature() const {
  return physics::HasDistribution(metadata_.microphysics, Hydrometeor::kSnow) &&
         std::ranges::find(metadata_.fields, Hydrometeor::kSnow) != metadata_.fields.end();
}

absl::Status TimeReader::ReadFields(volume::HydrometeorFields& result) {
  const std::size_t cells = air_.levels * air_.columns;
  THUNDERHEAD_ASSIGN_OR_RETURN(LayerState state, ReadState());
  std::shared_future<void> air_ready =
      std::async([this, state = std::move(state)]() mutable {
        if (NeedsTemperature()) air_.temperature_K = Temperature(state);
        air_.dry_air_density_kg_per_m3 =
            DryAirDensity(std::move(state), air_.interface_height_m, air_.columns);
      }).share();
  std::vector<float> next;
  std::future<absl::StatusOr<RemappedField>> pending;
  for (const Hydrometeor hydrometeor : metadata_.fields) {
    THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(std::string(WrfVariableOf(hydrometeor)), cells, next));
    std::vector<float> sizes;
    const volume::SizeVariable& size = metadata_.sizes[physics::IndexOf(hydrometeor)];
    if (!size.name.empty()) THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(size.name, cells, sizes));
    THUNDERHEAD_RETURN_IF_ERROR(Take(pending, result));
    pending = std::async([this, air_ready, hydrometeor, values = std::move(next),
                          sizes = std::move(sizes)]() mutable {
      air_ready.get();
      return Remap(hydrometeor, std::move(values), std::move(sizes));
    });
    next = std::exchange(buffer_, {});
  }
  THUNDERHEAD_RETURN_IF_ERROR(Take(pending, result));
  if (std::ranges::any_of(air_.dry_air_density_kg_per_m3, [](float rho) { return rho > 0.0F; })) {
    result.air = MeanDensity();
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat(
      file_.Path(), ": P + PB, T and QVAPOR of record ", record_,
      " give no usable air density in any cell; check their values and units (Pa, K, kg kg-1)"));
}

volume::AirDensity TimeReader::MeanDensity() const {
  volume::AirDensityMeans means(regular_);
  const glm::ivec2 stride = means.Stride();
  for (int y = 0; y < metadata_.cells.y; y += stride.y) {
    for (int x = 0; x < metadata_.cells.x; x += stride.x) {
      std::size_t at = regular_.Offset(x, y, 0);
      for (int level = 0; level < air_.levels; ++level, at += air_.columns) {
        means.Add(x, y, air_.interface_height_m[at], air_.interface_height_m[at + air_.columns],
                  air_.dry_air_density_kg_per_m3[at]);
      }
    }
  }
  return means.Means();
}

absl::StatusOr<StaggeredWind> TimeReader::ReadWind() {
  StaggeredWind wind;
  wind.cells = metadata_.cells;
  wind.dx_m = metadata_.dx_m;
  wind.dy_m = metadata_.dy_m;
  const std::size_t cells = air_.levels * air_.columns;
  const std::size_t walls = static_cast<std::size_t>(metadata_.cells.z);
  const std::size_t more_u = walls * static_cast<std::size_t>(metadata_.cells.y);
  const std::size_t more_v = walls * static_cast<std::size_t>(metadata_.cells.x);
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable("U", cells + more_u, wind.u_m_per_s));
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable("V", cells + more_v, wind.v_m_per_s));
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable("W", cells + air_.columns, wind.w_m_per_s));
  return wind;
}

// Returns the turbulent kinetic energy of each layer, in m2/s2.
absl::StatusOr<std::vector<float>> TimeReader::ReadEnergy() {
  const WrfMetadata::Energy& variable = metadata_.energy;
  const int levels = air_.levels + (variable.at_interfaces ? 1 : 0);
  std::vector<float> energy;
  THUNDERHEAD_RETURN_IF_ERROR(ReadVariable(variable.name, levels * air_.columns, energy));
  if (variable.at_interfaces) energy = LayerMeans(energy, air_.levels, air_.columns);
  if (!variable.doubled) return energy;
  for (float& value : energy) value *= 0.5F;
  return energy;
}

// Remaps values from 0 to 255 in layers to the regular grid. Missing values become 0.
std::vector<std::uint8_t> TimeReader::RemapBytes(const std::vector<float>& values) const {
  const std::vector<float> remapped =
      RemapColumns(air_.interface_height_m, values, air_.levels, air_.columns, grid_);
  std::vector<std::uint8_t> bytes(remapped.size());
  std::ranges::transform(remapped, bytes.begin(), [](float value) {
    return static_cast<std::uint8_t>(std::min(value + 0.5F, 255.0F));
  });
  return bytes;
}

absl::Status TimeReader::ReadMotion(volume::HydrometeorFields& result) {
  volume::AirMotion& motion = result.motion;
  std::vector<float> energy;
  if (!metadata_.energy.name.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(energy, ReadEnergy());
    motion.source = volume::TurbulenceSource::kEnergy;
    motion.variable = metadata_.energy.name;
  }
  if (metadata_.has_wind) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const StaggeredWind wind, ReadWind());
    if (energy.empty()) {
      energy = EnergyOfDeformation(WindInCells(wind, air_.interface_height_m));
      motion.source = volume::TurbulenceSource::kDeformation;
    }
    std::vector<float> ascent = LayerMeans(wind.w_m_per_s, air_.levels, air_.columns);
    std::ranges::transform(ascent, ascent.begin(), volume::AscentByte);
    motion.ascent = RemapBytes(ascent);
    const std::vector<glm::dvec2> winds = MeanWinds(wind.u_m_per_s, wind.v_m_per_s, wind.cells.z);
    motion.steering_m_per_s =
        SteeringWind_m_per_s(winds, LevelMeans(air_.interface_height_m, air_.levels + 1));
    motion.time_s = absl::ToDoubleSeconds(metadata_.times[record_] - absl::UnixEpoch());
    std::vector<double> first_column_m;
    for (std::size_t i = 0; i < air_.interface_height_m.size(); i += air_.columns) {
      first_column_m.push_back(air_.interface_height_m[i]);
    }
    motion.shear_m_per_s = Shear_m_per_s(result, winds, first_column_m);
  }
  if (energy.empty()) return absl::OkStatus();
  std::ranges::transform(energy, energy.begin(), volume::TurbulenceByte);
  motion.turbulence = RemapBytes(energy);
  return absl::OkStatus();
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

absl::StatusOr<volume::HydrometeorFields> TimeReader::Read(const std::optional<VerticalGrid>& grid,
                                                           const ReadCheckpoint& checkpoint) {
  checkpoint_ = checkpoint;
  THUNDERHEAD_RETURN_IF_ERROR(ReadHeights().status());
  THUNDERHEAD_ASSIGN_OR_RETURN(grid_, GridFor(grid));
  regular_.cells = {metadata_.cells.x, metadata_.cells.y, grid_.cells};
  regular_.spacing_m = {metadata_.dx_m, metadata_.dy_m, grid_.spacing_m};
  regular_.low_corner_m = {-0.5 * metadata_.dx_m * metadata_.cells.x,
                           -0.5 * metadata_.dy_m * metadata_.cells.y, grid_.low_m};
  volume::HydrometeorFields result;
  result.grid = regular_;
  THUNDERHEAD_RETURN_IF_ERROR(ReadTerrain(result));
  THUNDERHEAD_RETURN_IF_ERROR(ReadLand(result));
  THUNDERHEAD_RETURN_IF_ERROR(ReadFields(result));
  THUNDERHEAD_RETURN_IF_ERROR(ReadMotion(result));
  if (grid.has_value()) TrimTop(*grid, result);
  THUNDERHEAD_RETURN_IF_ERROR(Advance());
  return result;
}

// Runs `read` on a reader of the file. Running out of memory counts as an error of the input,
// because it must not end the server.
template <typename Result, typename ReadFunction>
absl::StatusOr<Result> WithReader(const WrfMetadata& metadata, std::size_t record,
                                  ReadFunction read) {
  try {
    THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(metadata.path));
    TimeReader reader(metadata, record, std::move(file));
    return read(reader);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return absl::ResourceExhaustedError(
      absl::StrCat(metadata.path, ": one time of ", metadata.cells.x, " x ", metadata.cells.y,
                   " x ", metadata.cells.z, " cells does not fit in memory; cut a smaller domain"));
}

}  // namespace

absl::StatusOr<volume::HydrometeorFields> ReadWrfTime(const WrfMetadata& metadata,
                                                      std::size_t record,
                                                      const std::optional<VerticalGrid>& grid,
                                                      const ReadCheckpoint& checkpoint) {
  return WithReader<volume::HydrometeorFields>(
      metadata, record, [&](TimeReader& reader) { return reader.Read(grid, checkpoint); });
}

absl::StatusOr<VerticalGrid> ReadWrfVerticalGrid(const WrfMetadata& metadata, std::size_t record) {
  return WithReader<VerticalGrid>(metadata, record,
                                  [](TimeReader& reader) { return reader.ReadHeights(); });
}

}  // namespace thunderhead::storm_files
