#include "storm_files/cf_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "netcdf/netcdf_file.h"

namespace thunderhead::storm_files {
namespace {

class CfSource final : public LayerSource {
 public:
  CfSource(std::shared_ptr<const CfMetadata> metadata, std::size_t record, netcdf::NetcdfFile file)
      : shared_metadata_(std::move(metadata)), file_(std::move(file)) {
    const auto& [x, y, z] = metadata_.axes;
    domain_.path = metadata_.path;
    domain_.record = record;
    domain_.time = metadata_.times[record];
    domain_.cells = {x.cells, y.cells, z.cells};
    domain_.dx_m = x.spacing_m;
    domain_.dy_m = y.spacing_m;
    domain_.fixed_heights = true;
    domain_.heights_from = z.dimension;
    for (const CfField& from : metadata_.fields) {
      LayerField& field = domain_.fields.emplace_back();
      field.hydrometeor = from.quantity.hydrometeor;
      field.variable = from.variable.name;
      field.quantity = from.quantity.quantity;
      field.per = from.quantity.of_moist_air ? AirMass::kWhole : AirMass::kDry;
    }
  }

  const LayerDomain& Domain() const override { return domain_; }
  absl::StatusOr<std::vector<float>> InterfaceHeights_m() override;
  absl::StatusOr<LayerState> Air() override;
  absl::StatusOr<LayerAmounts> Amounts(std::size_t field) override;
  absl::StatusOr<std::vector<float>> Terrain_m() override;
  absl::StatusOr<LayerEnergy> TurbulentEnergy() override;
  absl::StatusOr<ModelWind> Wind() override;

 private:
  absl::StatusOr<std::vector<float>> ReadLayers(const CfVariable& variable) const;
  absl::StatusOr<std::vector<float>> ReadWind(WindVariable wind) const;

  const std::shared_ptr<const CfMetadata> shared_metadata_;
  const CfMetadata& metadata_ = *shared_metadata_;
  LayerDomain domain_;
  netcdf::NetcdfFile file_;
};

// Returns the values of the record in the file's own layers. x runs fastest, then y (northwards),
// then height (upwards).
absl::StatusOr<std::vector<float>> CfSource::ReadLayers(const CfVariable& variable) const {
  const auto rank = static_cast<std::size_t>(variable.dimensions);
  std::vector<std::size_t> start(rank, 0);
  std::vector<std::size_t> count(rank, 1);
  const std::array places = {variable.x, variable.y, variable.z};
  std::array<std::size_t, 3> lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lengths[axis] = static_cast<std::size_t>(metadata_.axes[axis].cells);
    count[static_cast<std::size_t>(places[axis])] = lengths[axis];
  }
  if (variable.time >= 0) start[static_cast<std::size_t>(variable.time)] = domain_.record;
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

absl::StatusOr<std::vector<float>> CfSource::InterfaceHeights_m() {
  std::vector<float> heights_m;
  heights_m.reserve(metadata_.axes[2].faces_m.size() * domain_.Columns());
  for (const double face_m : metadata_.axes[2].faces_m) {
    heights_m.insert(heights_m.end(), domain_.Columns(), static_cast<float>(face_m));
  }
  return heights_m;
}

absl::StatusOr<LayerState> CfSource::Air() {
  LayerState state;
  for (const CfAirField& field : metadata_.air) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadLayers(field.variable));
    for (float& value : values) {
      value = static_cast<float>(value * field.air.scale + field.air.offset);
      if (field.air.of_moist_air) value /= 1.0F - value;
    }
    switch (field.air.variable) {
      case AirVariable::kDensity:
        state.air_density_kg_per_m3 = std::move(values);
        break;
      case AirVariable::kPressure:
        state.pressure_Pa = std::move(values);
        break;
      case AirVariable::kTemperature:
        state.temperature_K = std::move(values);
        break;
      case AirVariable::kPotentialTemperature:
        state.potential_temperature_K = std::move(values);
        break;
      case AirVariable::kVapour:
        state.vapour_kg_per_kg = std::move(values);
        break;
    }
  }
  return state;
}

absl::StatusOr<LayerAmounts> CfSource::Amounts(std::size_t field) {
  const CfField& from = metadata_.fields[field];
  LayerAmounts read;
  THUNDERHEAD_ASSIGN_OR_RETURN(read.amounts, ReadLayers(from.variable));
  const auto scale = static_cast<float>(from.quantity.scale);
  for (float& amount : read.amounts) amount *= scale;
  return read;
}

absl::StatusOr<std::vector<float>> CfSource::Terrain_m() {
  if (!metadata_.surface.has_value()) return std::vector<float>();
  const auto nx = static_cast<std::size_t>(domain_.cells.x);
  const auto ny = static_cast<std::size_t>(domain_.cells.y);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> read,
                               file_.ReadPart(metadata_.surface->variable, {0, 0}, {ny, nx}));
  const auto metres = static_cast<float>(metadata_.surface->metres);
  std::vector<float> terrain_m(nx * ny);
  for (std::size_t y = 0; y < ny; ++y) {
    for (std::size_t x = 0; x < nx; ++x) {
      const std::size_t from_y = metadata_.axes[1].reversed ? ny - 1 - y : y;
      const std::size_t from_x = metadata_.axes[0].reversed ? nx - 1 - x : x;
      terrain_m[y * nx + x] = read[from_y * nx + from_x] * metres;
    }
  }
  return terrain_m;
}

// Returns the wind in layers, or an empty array if the file does not have it.
absl::StatusOr<std::vector<float>> CfSource::ReadWind(WindVariable wind) const {
  const auto field = std::ranges::find(metadata_.wind, wind, &CfWindField::wind);
  if (field == metadata_.wind.end()) return std::vector<float>();
  return ReadLayers(field->variable);
}

absl::StatusOr<LayerEnergy> CfSource::TurbulentEnergy() {
  const auto field =
      std::ranges::find(metadata_.wind, WindVariable::kTurbulentEnergy, &CfWindField::wind);
  if (field == metadata_.wind.end()) return LayerEnergy();
  LayerEnergy energy{field->variable.name, {}};
  THUNDERHEAD_ASSIGN_OR_RETURN(energy.energy_m2_per_s2, ReadLayers(field->variable));
  return energy;
}

absl::StatusOr<ModelWind> CfSource::Wind() {
  ModelWind wind;
  wind.cells = domain_.cells;
  wind.dx_m = domain_.dx_m;
  wind.dy_m = domain_.dy_m;
  wind.on_faces = false;
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.u_m_per_s, ReadWind(WindVariable::kEastward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.v_m_per_s, ReadWind(WindVariable::kNorthward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.w_m_per_s, ReadWind(WindVariable::kUpward));
  return wind;
}

}  // namespace

absl::StatusOr<std::unique_ptr<LayerSource>> OpenCfTime(std::shared_ptr<const CfMetadata> metadata,
                                                        std::size_t record) {
  THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(metadata->path));
  return std::make_unique<CfSource>(std::move(metadata), record, std::move(file));
}

}  // namespace thunderhead::storm_files
