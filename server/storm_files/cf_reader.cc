#include "storm_files/cf_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "physics/air.h"
#include "storm_files/field_scan.h"
#include "storm_files/wind_motion.h"
#include "volume/air_motion.h"

namespace thunderhead::storm_files {
namespace {

// The plausible range of mixing ratios in kg/kg. Smaller values are codes for "missing", and air
// never holds more than kMaxAmount.
constexpr float kMinAmount = -0.5F;
constexpr float kMaxAmount = 0.5F;

std::vector<std::uint8_t> BytesOf(const std::vector<float>& values, float (*byte_of)(float)) {
  std::vector<std::uint8_t> bytes(values.size());
  std::ranges::transform(values, bytes.begin(), [&](float value) {
    return static_cast<std::uint8_t>(std::min(byte_of(value) + 0.5F, 255.0F));
  });
  return bytes;
}

class CfTimeReader {
 public:
  CfTimeReader(const CfMetadata& metadata, std::size_t record, netcdf::NetcdfFile file)
      : metadata_(metadata), record_(record), file_(std::move(file)) {
    for (int axis = 0; axis < 3; ++axis) {
      const CfAxis& from = metadata.axes[static_cast<std::size_t>(axis)];
      grid_.cells[axis] = from.cells;
      grid_.spacing_m[axis] = from.spacing_m;
      grid_.low_corner_m[axis] = axis < 2 ? -0.5 * from.cells * from.spacing_m : from.low_m;
    }
  }

  absl::StatusOr<volume::HydrometeorFields> Read(const ReadCheckpoint& checkpoint);

 private:
  absl::StatusOr<std::vector<float>> ReadLayers(const CfVariable& variable) const;
  absl::StatusOr<volume::HydrometeorField> ReadField(const CfField& field);
  absl::Status ReadAir();
  float DensityAt(std::size_t cell, bool moist) const;
  std::vector<float> OntoGrid(std::vector<float> layers) const;
  void AddPaths(volume::HydrometeorField* field) const;
  absl::Status ReadTerrain(volume::HydrometeorFields* fields) const;
  absl::StatusOr<std::vector<float>> ReadWind(WindVariable wind) const;
  absl::Status ReadMotion(volume::HydrometeorFields* fields) const;
  volume::AirDensity MeanDensity(bool moist) const;

  const std::vector<float>* Air(AirVariable variable) const {
    const auto at =
        std::ranges::find(air_, variable, &std::pair<AirVariable, std::vector<float>>::first);
    return at == air_.end() ? nullptr : &at->second;
  }

  const CfMetadata& metadata_;
  std::size_t record_;
  netcdf::NetcdfFile file_;
  volume::RegularGrid grid_;
  std::vector<std::pair<AirVariable, std::vector<float>>> air_;
};

// Returns the values of the record in the file's own layers. x runs fastest, then y (northwards),
// then height (upwards).
absl::StatusOr<std::vector<float>> CfTimeReader::ReadLayers(const CfVariable& variable) const {
  const auto rank = static_cast<std::size_t>(variable.dimensions);
  std::vector<std::size_t> start(rank, 0);
  std::vector<std::size_t> count(rank, 1);
  const std::array places = {variable.x, variable.y, variable.z};
  std::array<std::size_t, 3> lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lengths[axis] = static_cast<std::size_t>(metadata_.axes[axis].file_cells);
    count[static_cast<std::size_t>(places[axis])] = lengths[axis];
  }
  if (variable.time >= 0) start[static_cast<std::size_t>(variable.time)] = record_;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> read,
                               file_.ReadPart(variable.name, start, count));
  // Strides of x, y and z in the array that was read. A reversed axis is traversed from its end.
  std::array<std::ptrdiff_t, 3> strides{};
  std::ptrdiff_t origin = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::ptrdiff_t stride = 1;
    for (auto i = static_cast<std::size_t>(places[axis]) + 1; i < rank; ++i) {
      stride *= static_cast<std::ptrdiff_t>(count[i]);
    }
    const bool reversed = metadata_.axes[axis].reversed;
    if (reversed) origin += stride * (static_cast<std::ptrdiff_t>(lengths[axis]) - 1);
    strides[axis] = reversed ? -stride : stride;
  }
  std::vector<float> values(read.size());
  std::size_t to = 0;
  for (std::size_t z = 0; z < lengths[2]; ++z) {
    for (std::size_t y = 0; y < lengths[1]; ++y) {
      std::ptrdiff_t from = origin + static_cast<std::ptrdiff_t>(z) * strides[2] +
                            static_cast<std::ptrdiff_t>(y) * strides[1];
      for (std::size_t x = 0; x < lengths[0]; ++x, from += strides[0]) {
        values[to++] = read[static_cast<std::size_t>(from)];
      }
    }
  }
  return values;
}

absl::Status CfTimeReader::ReadAir() {
  for (const CfAirField& field : metadata_.air) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadLayers(field.variable));
    for (float& value : values) {
      value = static_cast<float>(value * field.air.scale + field.air.offset);
      if (field.air.of_moist_air) value /= 1.0F - value;
    }
    air_.emplace_back(field.air.variable, std::move(values));
  }
  return absl::OkStatus();
}

// Returns the density (kg/m3) by which to multiply a mixing ratio in `cell`, or NaN if unknown.
float CfTimeReader::DensityAt(std::size_t cell, bool moist) const {
  const std::vector<float>* vapour = Air(AirVariable::kVapour);
  const double q_v = vapour != nullptr ? std::max((*vapour)[cell], 0.0F) : 0.0;
  if (const std::vector<float>* density = Air(AirVariable::kDensity); density != nullptr) {
    return (*density)[cell] / static_cast<float>(moist ? 1.0 : 1.0 + q_v);
  }
  const double pressure_Pa = (*Air(AirVariable::kPressure))[cell];
  if (!(pressure_Pa > 0.0)) return std::numeric_limits<float>::quiet_NaN();
  const std::vector<float>* temperature = Air(AirVariable::kTemperature);
  const double temperature_K =
      temperature != nullptr
          ? (*temperature)[cell]
          : physics::Temperature_K((*Air(AirVariable::kPotentialTemperature))[cell], pressure_Pa);
  if (!(temperature_K > 0.0)) return std::numeric_limits<float>::quiet_NaN();
  const double dry = physics::DryAirDensity_kg_per_m3(pressure_Pa, temperature_K, q_v);
  return static_cast<float>(moist ? dry * (1.0 + q_v) : dry);
}

std::vector<float> CfTimeReader::OntoGrid(std::vector<float> layers) const {
  const CfAxis& axis = metadata_.axes[2];
  if (axis.shares.empty()) return layers;
  const std::size_t columns = static_cast<std::size_t>(grid_.cells.x) * grid_.cells.y;
  std::vector<float> cells(grid_.CellCount(), 0.0F);
  for (std::size_t z = 0; z < axis.shares.size(); ++z) {
    for (const LayerShare& part : axis.shares[z]) {
      const float* from = layers.data() + static_cast<std::size_t>(part.layer) * columns;
      float* to = cells.data() + z * columns;
      const auto share = static_cast<float>(part.share);
      for (std::size_t i = 0; i < columns; ++i) to[i] += share * from[i];
    }
  }
  return cells;
}

void CfTimeReader::AddPaths(volume::HydrometeorField* field) const {
  const std::size_t columns = static_cast<std::size_t>(grid_.cells.x) * grid_.cells.y;
  double total = 0.0;
  double largest = 0.0;
  for (std::size_t column = 0; column < columns; ++column) {
    double sum = 0.0;
    for (int z = 0; z < grid_.cells.z; ++z) {
      sum += field->concentration_kg_per_m3[column + static_cast<std::size_t>(z) * columns];
    }
    total += sum * grid_.spacing_m.z;
    largest = std::max(largest, sum * grid_.spacing_m.z);
  }
  field->statistics.mean_water_path_kg_per_m2 = total / static_cast<double>(columns);
  field->statistics.maximum_water_path_kg_per_m2 = largest;
}

absl::StatusOr<volume::HydrometeorField> CfTimeReader::ReadField(const CfField& from) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadLayers(from.variable));
  volume::HydrometeorField field;
  field.hydrometeor = from.quantity.hydrometeor;
  field.variable = from.variable.name;
  field.quantity = from.quantity.quantity;
  volume::FieldStatistics& statistics = field.statistics;
  const bool ratio = field.quantity == volume::Quantity::kMixingRatio;
  const auto scale = static_cast<float>(from.quantity.scale);
  float minimum = std::numeric_limits<float>::infinity();
  float maximum = -std::numeric_limits<float>::infinity();
  for (std::size_t cell = 0; cell < values.size(); ++cell) {
    const float value = values[cell] * scale;
    const float density = ratio ? DensityAt(cell, from.quantity.of_moist_air) : 1.0F;
    // Both comparisons fail for NaN.
    const bool present = value > kMinAmount && density > 0.0F;
    values[cell] = present ? std::max(value, 0.0F) * density : 0.0F;
    statistics.missing_cells += present ? 0 : 1;
    if (!present) continue;
    statistics.negative_cells += value < 0.0F ? 1 : 0;
    minimum = std::min(minimum, value);
    maximum = std::max(maximum, value);
  }
  if (minimum <= maximum) {
    statistics.minimum = minimum;
    statistics.maximum = maximum;
  }
  if (field.quantity != volume::Quantity::kExtinction && statistics.maximum > kMaxAmount) {
    return absl::InvalidArgumentError(
        absl::StrCat(file_.Path(), ": ", field.variable, " of record ", record_, " reaches ",
                     statistics.maximum, " ", std::string(volume::UnitOf(field.quantity)),
                     ", more than air can hold; if it is in g, set its units attribute"));
  }
  field.concentration_kg_per_m3 = OntoGrid(std::move(values));
  return field;
}

// Sets the ground's height from the file. Without it, the ground is at sea level or, if lower, at
// the bottom of the domain.
absl::Status CfTimeReader::ReadTerrain(volume::HydrometeorFields* fields) const {
  const auto ground_m = static_cast<float>(std::min(0.0, grid_.low_corner_m.z));
  const auto nx = static_cast<std::size_t>(grid_.cells.x);
  const auto ny = static_cast<std::size_t>(grid_.cells.y);
  std::vector<float>& terrain = fields->terrain_height_m;
  terrain.assign(nx * ny, ground_m);
  if (!metadata_.surface.has_value()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> read,
                               file_.ReadPart(metadata_.surface->variable, {0, 0}, {ny, nx}));
  const auto metres = static_cast<float>(metadata_.surface->metres);
  for (std::size_t y = 0; y < ny; ++y) {
    for (std::size_t x = 0; x < nx; ++x) {
      const std::size_t from_y = metadata_.axes[1].reversed ? ny - 1 - y : y;
      const std::size_t from_x = metadata_.axes[0].reversed ? nx - 1 - x : x;
      const float height_m = read[from_y * nx + from_x] * metres;
      if (!std::isnan(height_m)) terrain[y * nx + x] = height_m;
    }
  }
  return absl::OkStatus();
}

// Returns the wind on the grid, or an empty array if the file does not have it.
absl::StatusOr<std::vector<float>> CfTimeReader::ReadWind(WindVariable wind) const {
  const auto field = std::ranges::find(metadata_.wind, wind, &CfWindField::wind);
  if (field == metadata_.wind.end()) return std::vector<float>();
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> layers, ReadLayers(field->variable));
  return OntoGrid(std::move(layers));
}

absl::Status CfTimeReader::ReadMotion(volume::HydrometeorFields* fields) const {
  volume::AirMotion& motion = fields->motion;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> energy, ReadWind(WindVariable::kTurbulentEnergy));
  if (!energy.empty()) {
    motion.source = volume::TurbulenceSource::kEnergy;
    motion.variable =
        std::ranges::find(metadata_.wind, WindVariable::kTurbulentEnergy, &CfWindField::wind)
            ->variable.name;
  }
  Wind wind = {.cells = grid_.cells, .dx_m = grid_.spacing_m.x, .dy_m = grid_.spacing_m.y};
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.u_m_per_s, ReadWind(WindVariable::kEastward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.v_m_per_s, ReadWind(WindVariable::kNorthward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.w_m_per_s, ReadWind(WindVariable::kUpward));
  if (!wind.u_m_per_s.empty()) {
    std::vector<double> interface_height_m;
    for (int level = 0; level <= grid_.cells.z; ++level) {
      interface_height_m.push_back(grid_.low_corner_m.z + level * grid_.spacing_m.z);
    }
    if (energy.empty()) {
      for (int level = 0; level < grid_.cells.z; ++level) {
        const double middle_m =
            interface_height_m[static_cast<std::size_t>(level)] + 0.5 * grid_.spacing_m.z;
        wind.height_m.insert(wind.height_m.end(), grid_.Offset(0, 0, 1),
                             static_cast<float>(middle_m));
      }
      energy = EnergyOfDeformation(wind);
      motion.source = volume::TurbulenceSource::kDeformation;
    }
    motion.ascent = BytesOf(wind.w_m_per_s, volume::AscentByte);
    const std::vector<glm::dvec2> winds = MeanWinds(wind.u_m_per_s, wind.v_m_per_s, grid_.cells.z);
    motion.steering_m_per_s = SteeringWind_m_per_s(winds, interface_height_m);
    motion.shear_m_per_s = Shear_m_per_s(*fields, winds, interface_height_m);
    motion.time_s = absl::ToDoubleSeconds(metadata_.times[record_] - absl::UnixEpoch());
  }
  motion.turbulence = BytesOf(energy, volume::TurbulenceByte);
  return absl::OkStatus();
}

// Returns block means of the air density that mixing ratios refer to. There is only one result for
// all fields: `moist` is that of the first field, even if other fields differ.
volume::AirDensity CfTimeReader::MeanDensity(bool moist) const {
  const CfAxis& axis = metadata_.axes[2];
  const std::size_t columns = grid_.Offset(0, 0, 1);
  volume::AirDensityMeans means(grid_);
  const glm::ivec2 stride = means.Stride();
  for (int z = 0; z < grid_.cells.z; ++z) {
    const std::vector<LayerShare> own = {{z, 1.0}};
    const std::vector<LayerShare>& layers =
        axis.shares.empty() ? own : axis.shares[static_cast<std::size_t>(z)];
    double bottom_m = grid_.low_corner_m.z + z * grid_.spacing_m.z;
    for (const LayerShare& part : layers) {
      const double top_m = bottom_m + part.share * grid_.spacing_m.z;
      for (int y = 0; y < grid_.cells.y; y += stride.y) {
        for (int x = 0; x < grid_.cells.x; x += stride.x) {
          const std::size_t cell =
              static_cast<std::size_t>(part.layer) * columns + grid_.Offset(x, y, 0);
          means.Add(x, y, bottom_m, top_m, DensityAt(cell, moist));
        }
      }
      bottom_m = top_m;
    }
  }
  return means.Means();
}

absl::StatusOr<volume::HydrometeorFields> CfTimeReader::Read(const ReadCheckpoint& checkpoint) {
  const auto steps = static_cast<double>(metadata_.fields.size() + metadata_.wind.size() + 1);
  const auto advance = [&](double done) {
    return checkpoint ? checkpoint(done / steps) : absl::OkStatus();
  };
  volume::HydrometeorFields result;
  result.grid = grid_;
  THUNDERHEAD_RETURN_IF_ERROR(advance(0.0));
  THUNDERHEAD_RETURN_IF_ERROR(ReadAir());
  THUNDERHEAD_RETURN_IF_ERROR(ReadTerrain(&result));
  for (const CfField& from : metadata_.fields) {
    THUNDERHEAD_RETURN_IF_ERROR(advance(static_cast<double>(result.fields.size() + 1)));
    THUNDERHEAD_ASSIGN_OR_RETURN(volume::HydrometeorField field, ReadField(from));
    const volume::CellBox box = FlushAndBound(grid_, field.concentration_kg_per_m3);
    if (box.Empty()) {
      field.concentration_kg_per_m3 = {};
    } else {
      AddPaths(&field);
    }
    result.condensate = Union(result.condensate, box);
    result.fields.push_back(std::move(field));
  }
  const auto ratio =
      std::ranges::find(metadata_.fields, volume::Quantity::kMixingRatio,
                        [](const CfField& field) { return field.quantity.quantity; });
  if (ratio != metadata_.fields.end()) result.air = MeanDensity(ratio->quantity.of_moist_air);
  THUNDERHEAD_RETURN_IF_ERROR(advance(static_cast<double>(result.fields.size() + 1)));
  THUNDERHEAD_RETURN_IF_ERROR(ReadMotion(&result));
  THUNDERHEAD_RETURN_IF_ERROR(advance(steps));
  return result;
}

}  // namespace

absl::StatusOr<volume::HydrometeorFields> ReadCfTime(const CfMetadata& metadata, std::size_t record,
                                                     const ReadCheckpoint& checkpoint) {
  try {
    THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(metadata.path));
    return CfTimeReader(metadata, record, std::move(file)).Read(checkpoint);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return absl::ResourceExhaustedError(absl::StrCat(
      metadata.path, ": one time of ", metadata.axes[0].cells, " x ", metadata.axes[1].cells, " x ",
      metadata.axes[2].cells, " cells does not fit in memory; cut a smaller domain"));
}

}  // namespace thunderhead::storm_files
