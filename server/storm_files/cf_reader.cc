#include "storm_files/cf_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/grib_air.h"
#include "storm_files/ground.h"

namespace thunderhead::storm_files {
namespace {

class CfSource final : public LayerSource {
 public:
  CfSource(std::shared_ptr<const CfMetadata> metadata, std::size_t record, netcdf::NetcdfFile file,
           std::optional<netcdf::NetcdfFile> heights_file)
      : shared_metadata_(std::move(metadata)),
        file_(std::move(file)),
        heights_file_(std::move(heights_file)) {
    const CfHeights& heights = metadata_.heights;
    domain_.path = metadata_.path;
    domain_.record = record;
    domain_.time = metadata_.times[record];
    domain_.cells = {metadata_.x.cells, metadata_.y.cells,
                     static_cast<int>(metadata_.order.cells[2])};
    const CfPlaces& places = metadata_.moved.empty() || metadata_.moved[record] == nullptr
                                 ? metadata_.places
                                 : *metadata_.moved[record];
    domain_.dx_m = places.dx_m;
    domain_.dy_m = places.dy_m;
    domain_.even = places.even;
    domain_.on_terrain = heights.kind != CfHeightKind::kAxis &&
                         (heights.kind != CfHeightKind::kAboveGround || heights.faces_m[0] == 0.0);
    domain_.fixed_heights =
        !FollowFromAir(heights.kind) && (!heights.array.has_value() || heights.array->time < 0);
    domain_.heights_from = heights.name;
    domain_.ground_from =
        metadata_.terrain.has_value() ? metadata_.terrain->variable.name : std::string("origin_z");
    std::vector<std::string> air;
    for (const CfAirField& from : metadata_.air) {
      if (from.air.variable == AirVariable::kVapour) {
        domain_.vapour_from = from.variable.name;
      } else {
        air.push_back(from.variable.name);
      }
    }
    domain_.air_from = absl::StrJoin(air, ", ");
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
  absl::StatusOr<std::vector<float>> ReadOrdered(const CfVariable& variable,
                                                 const CfOrder& order) const;
  absl::StatusOr<std::vector<float>> ReadScaled(const CfVariable& variable, double scale,
                                                double offset = 0.0) const;
  absl::StatusOr<std::vector<float>> ReadColumns(const CfColumnValue& value) const;
  absl::StatusOr<std::vector<float>> ReadMotion(const CfWindField& field) const;
  absl::StatusOr<std::vector<float>> ReadWind(WindVariable wind) const;
  absl::StatusOr<std::vector<float>> ReadAir(const CfAirField& field) const;
  absl::StatusOr<std::vector<float>> Faces_m();
  absl::StatusOr<std::vector<float>> FacesOfArray(const std::vector<float>& terrain_m) const;
  absl::StatusOr<std::vector<float>> HydrostaticFaces(const std::vector<float>& terrain_m);
  absl::StatusOr<std::vector<float>> IsobaricFaces(const std::vector<float>& terrain_m);
  absl::StatusOr<std::vector<float>> LinearFaces() const;
  absl::Status AddReference(std::vector<float>& pressure_Pa);

  const std::shared_ptr<const CfMetadata> shared_metadata_;
  const CfMetadata& metadata_ = *shared_metadata_;
  LayerDomain domain_;
  netcdf::NetcdfFile file_;
  std::optional<netcdf::NetcdfFile> heights_file_;
};

// Reads one record from the file that the variable is in. A file of heights has one time only.
absl::StatusOr<std::vector<float>> CfSource::ReadOrdered(const CfVariable& variable,
                                                         const CfOrder& order) const {
  return variable.of_heights_file ? ReadOnAxes(*heights_file_, variable, order, 0)
                                  : ReadOnAxes(file_, variable, order, domain_.record);
}

absl::StatusOr<std::vector<float>> CfSource::ReadScaled(const CfVariable& variable, double scale,
                                                        double offset) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadOrdered(variable, metadata_.order));
  if (scale == 1.0 && offset == 0.0) return values;
  bool overflows = false;
  for (float& value : values) {
    value = static_cast<float>(value * scale + offset);
    overflows = overflows || std::isinf(value);
  }
  if (!overflows) return values;
  return absl::InvalidArgumentError(absl::StrCat(
      metadata_.path, ": ", variable.name, " of record ", domain_.record,
      " has a value that no quantity has, because of its units; correct its attribute units"));
}

// Returns one value for each column.
absl::StatusOr<std::vector<float>> CfSource::ReadColumns(const CfColumnValue& value) const {
  CfOrder flat = metadata_.order;
  flat.cells[2] = 1;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadOrdered(value.variable, flat));
  for (float& each : values) each = static_cast<float>(each * value.scale);
  return values;
}

// Returns the heights of the layers' faces from an array of heights.
absl::StatusOr<std::vector<float>> CfSource::FacesOfArray(
    const std::vector<float>& terrain_m) const {
  const CfHeights& heights = metadata_.heights;
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> heights_m,
                               ReadScaled(*heights.array, heights.scale));
  const std::size_t columns = domain_.Columns();
  if (heights.above_ground && !terrain_m.empty()) {
    for (std::size_t i = 0; i < heights_m.size(); ++i) heights_m[i] += terrain_m[i % columns];
  }
  if (heights.kind == CfHeightKind::kMiddles) {
    heights_m = InterfacesBetween(heights_m, terrain_m, domain_.cells.z, columns);
  }
  RaiseToGround(terrain_m, heights_m);
  return heights_m;
}

// Computes the faces of layers whose pressure is known.
absl::StatusOr<std::vector<float>> CfSource::HydrostaticFaces(const std::vector<float>& terrain_m) {
  const CfHeights& heights = metadata_.heights;
  const std::size_t columns = domain_.Columns();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> surface_Pa,
                               ReadColumns(*heights.surface_pressure));
  std::vector<float> face_pressure_Pa(heights.a.size() * columns);
  for (std::size_t i = 0; i < face_pressure_Pa.size(); ++i) {
    face_pressure_Pa[i] = static_cast<float>(heights.a[i / columns] +
                                             heights.b[i / columns] * surface_Pa[i % columns]);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const LayerState state, Air());
  std::vector<float> ground_m = terrain_m;
  ground_m.resize(columns, 0.0F);
  return HydrostaticInterfaces(
      face_pressure_Pa, VirtualTemperature_K(Temperature(state), state.vapour_kg_per_kg), ground_m);
}

// Computes the faces around levels of constant pressure.
absl::StatusOr<std::vector<float>> CfSource::IsobaricFaces(const std::vector<float>& terrain_m) {
  const std::vector<double>& pressure_Pa = metadata_.heights.a_middle;
  const std::size_t columns = domain_.Columns();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> surface_Pa,
                               ReadColumns(*metadata_.heights.surface_pressure));
  THUNDERHEAD_ASSIGN_OR_RETURN(const LayerState state, Air());
  std::vector<float> virtual_K = VirtualTemperature_K(Temperature(state), state.vapour_kg_per_kg);
  // Files often lack values below the ground. The level above then gives the temperature between
  // it and the ground.
  for (std::size_t i = virtual_K.size() - columns; i-- > 0;) {
    const bool is_below = pressure_Pa[i / columns] > surface_Pa[i % columns];
    if (is_below && std::isnan(virtual_K[i])) virtual_K[i] = virtual_K[i + columns];
  }
  std::vector<float> heights_m(virtual_K.size(), std::nanf(""));
  const std::vector<bool> has_height(pressure_Pa.size(), false);
  FillHeights(pressure_Pa, virtual_K, has_height, surface_Pa, terrain_m, heights_m);
  std::vector<float> faces_m = InterfacesBetween(heights_m, terrain_m, domain_.cells.z, columns);
  CutAtGround(pressure_Pa, heights_m, surface_Pa, terrain_m, faces_m);
  return faces_m;
}

// Returns the faces of layers whose heights are linear in one or two surfaces.
absl::StatusOr<std::vector<float>> CfSource::LinearFaces() const {
  const CfHeights& heights = metadata_.heights;
  const std::size_t columns = domain_.Columns();
  std::vector<float> heights_m;
  for (const double a_m : heights.a) {
    heights_m.insert(heights_m.end(), columns, static_cast<float>(a_m));
  }
  for (const CfSurfaceTerm& term : heights.surfaces) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> surface_m, ReadColumns(term.surface));
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
      heights_m[i] += static_cast<float>(term.b[i / columns] * surface_m[i % columns]);
    }
  }
  return heights_m;
}

// Returns the faces of the layers. It is an error if most columns reach far above the weather,
// because the heights then are in another unit. A single impossible height is missing later.
absl::StatusOr<std::vector<float>> CfSource::InterfaceHeights_m() {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> faces_m, Faces_m());
  // Computed heights follow from the air and not from a unit of length.
  if (FollowFromAir(metadata_.heights.kind)) return faces_m;
  const std::size_t columns = domain_.Columns();
  std::size_t too_high = 0;
  float highest_m = 0.0F;
  for (std::size_t i = faces_m.size() - columns; i < faces_m.size(); ++i) {
    if (!(faces_m[i] > kHighestTop_m)) continue;
    ++too_high;
    highest_m = std::max(highest_m, faces_m[i]);
  }
  if (2 * too_high <= columns) return faces_m;
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: the heights %s of record %d reach up to %g km, far above the weather; correct their "
      "units attribute",
      metadata_.path, metadata_.heights.name, domain_.record, highest_m / 1000.0F));
}

absl::StatusOr<std::vector<float>> CfSource::Faces_m() {
  const CfHeights& heights = metadata_.heights;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> terrain_m, Terrain_m());
  const std::size_t columns = domain_.Columns();
  const std::size_t faces = metadata_.order.cells[2] + 1;
  const auto ground_m = [&](std::size_t column) {
    return terrain_m.empty() ? 0.0F : terrain_m[column];
  };
  std::vector<float> heights_m;
  switch (heights.kind) {
    case CfHeightKind::kMiddles:
    case CfHeightKind::kFaces:
      return FacesOfArray(terrain_m);
    case CfHeightKind::kPressure:
      return HydrostaticFaces(terrain_m);
    case CfHeightKind::kIsobaric:
      return IsobaricFaces(terrain_m);
    case CfHeightKind::kAxis:
      for (const double face_m : heights.faces_m) {
        heights_m.insert(heights_m.end(), columns, static_cast<float>(face_m));
      }
      break;
    case CfHeightKind::kAboveGround:
      heights_m.resize(faces * columns);
      for (std::size_t i = 0; i < heights_m.size(); ++i) {
        heights_m[i] = static_cast<float>(heights.faces_m[i / columns] + ground_m(i % columns));
      }
      break;
    case CfHeightKind::kLinear:
      return LinearFaces();
  }
  return heights_m;
}

absl::StatusOr<std::vector<float>> CfSource::ReadAir(const CfAirField& field) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values,
                               ReadScaled(field.variable, field.air.scale, field.air.offset));
  if (field.air.of_moist_air) SpecificHumidityToVapour(values);
  return values;
}

// Adds the pressure of the reference atmosphere at the middles of the layers.
absl::Status CfSource::AddReference(std::vector<float>& pressure_Pa) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> faces_m, InterfaceHeights_m());
  for (std::size_t i = 0; i < pressure_Pa.size(); ++i) {
    const double middle_m = 0.5 * (faces_m[i] + faces_m[i + domain_.Columns()]);
    pressure_Pa[i] += static_cast<float>(metadata_.reference->Pressure_Pa(middle_m));
  }
  return absl::OkStatus();
}

absl::StatusOr<LayerState> CfSource::Air() {
  LayerState state;
  for (const CfAirField& field : metadata_.air) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values, ReadAir(field));
    switch (field.air.variable) {
      case AirVariable::kDensity:
        state.air_density_kg_per_m3 = std::move(values);
        break;
      case AirVariable::kPressure:
        state.pressure_Pa = std::move(values);
        break;
      case AirVariable::kPressureDeviation:
        THUNDERHEAD_RETURN_IF_ERROR(AddReference(values));
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
  const CfHeights& heights = metadata_.heights;
  if (heights.kind != CfHeightKind::kPressure || !state.pressure_Pa.empty()) return state;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> surface_Pa,
                               ReadColumns(*heights.surface_pressure));
  state.pressure_Pa.resize(metadata_.order.cells[2] * domain_.Columns());
  for (std::size_t i = 0; i < state.pressure_Pa.size(); ++i) {
    const std::size_t layer = i / domain_.Columns();
    state.pressure_Pa[i] = static_cast<float>(
        heights.a_middle[layer] + heights.b_middle[layer] * surface_Pa[i % domain_.Columns()]);
  }
  return state;
}

absl::StatusOr<LayerAmounts> CfSource::Amounts(std::size_t field) {
  const CfField& from = metadata_.fields[field];
  LayerAmounts read;
  THUNDERHEAD_ASSIGN_OR_RETURN(read.amounts, ReadScaled(from.variable, from.quantity.scale));
  if (std::ranges::all_of(read.amounts, [](float value) { return std::isnan(value); })) {
    return absl::DataLossError(absl::StrCat(
        metadata_.path, ": ", from.variable.name, " of record ", domain_.record,
        " holds nothing but missing values; write the file again, with values of this variable or "
        "without it"));
  }
  if (from.quantity.mixed == MixedWater::kNone) return read;
  THUNDERHEAD_ASSIGN_OR_RETURN(const LayerState state, Air());
  const std::vector<float> temperature_K = Temperature(state);
  for (std::size_t i = 0; i < read.amounts.size(); ++i) {
    read.amounts[i] *= ShareOf(from.quantity.mixed, from.quantity.hydrometeor, temperature_K[i]);
  }
  return read;
}

absl::StatusOr<std::vector<float>> CfSource::Terrain_m() {
  if (!metadata_.terrain.has_value()) {
    const std::optional<double>& ground_m = metadata_.heights.ground_m;
    return ground_m.has_value()
               ? std::vector<float>(domain_.Columns(), static_cast<float>(*ground_m))
               : std::vector<float>();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> terrain_m, ReadColumns(*metadata_.terrain));
  // Layers cannot follow a surface that is missing, even if the ground is there.
  for (const CfSurfaceTerm& term : metadata_.heights.surfaces) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> surface_m, ReadColumns(term.surface));
    for (std::size_t i = 0; i < terrain_m.size(); ++i) {
      if (std::isnan(surface_m[i])) terrain_m[i] = surface_m[i];
    }
  }
  return terrain_m;
}

// Reads a component of the wind, or turbulent energy, at the cells' centres. Values on faces are
// averaged.
absl::StatusOr<std::vector<float>> CfSource::ReadMotion(const CfWindField& field) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<float> values,
                               ReadScaled(field.variable, field.wind.scale));
  const auto& more = field.variable.more;
  if (more == std::array<int, 3>{0, 0, 0}) return values;
  const auto& cells = metadata_.order.cells;
  const std::size_t nx = cells[0] + static_cast<std::size_t>(more[0]);
  const std::size_t ny = cells[1] + static_cast<std::size_t>(more[1]);
  const std::size_t next = more[0] > 0 ? 1 : more[1] > 0 ? nx : nx * ny;
  std::vector<float> means;
  means.reserve(cells[0] * cells[1] * cells[2]);
  for (std::size_t z = 0; z < cells[2]; ++z) {
    for (std::size_t y = 0; y < cells[1]; ++y) {
      for (std::size_t x = 0; x < cells[0]; ++x) {
        const std::size_t at = (z * ny + y) * nx + x;
        means.push_back(0.5F * (values[at] + values[at + next]));
      }
    }
  }
  return means;
}

// Returns the wind in layers, or an empty array if the file does not have it.
absl::StatusOr<std::vector<float>> CfSource::ReadWind(WindVariable wind) const {
  for (const CfWindField& field : metadata_.wind) {
    if (field.wind.variable == wind) return ReadMotion(field);
  }
  return std::vector<float>();
}

absl::StatusOr<LayerEnergy> CfSource::TurbulentEnergy() {
  for (const CfWindField& field : metadata_.wind) {
    if (field.wind.variable != WindVariable::kTurbulentEnergy) continue;
    LayerEnergy energy{field.variable.name, {}};
    THUNDERHEAD_ASSIGN_OR_RETURN(energy.energy_m2_per_s2, ReadMotion(field));
    return energy;
  }
  return LayerEnergy();
}

absl::StatusOr<ModelWind> CfSource::Wind() {
  ModelWind wind;
  wind.cells = domain_.cells;
  wind.dx_m = domain_.dx_m;
  wind.dy_m = domain_.dy_m;
  wind.on_faces = false;
  wind.in_order = !metadata_.dimensions.unstructured;
  wind.east_and_north =
      domain_.even != nullptr && std::ranges::any_of(metadata_.wind, [](const CfWindField& field) {
        return field.wind.variable == WindVariable::kEastward && field.wind.true_east;
      });
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.u_m_per_s, ReadWind(WindVariable::kEastward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.v_m_per_s, ReadWind(WindVariable::kNorthward));
  THUNDERHEAD_ASSIGN_OR_RETURN(wind.w_m_per_s, ReadWind(WindVariable::kUpward));
  return wind;
}

}  // namespace

absl::StatusOr<std::unique_ptr<LayerSource>> OpenCfTime(std::shared_ptr<const CfMetadata> metadata,
                                                        std::size_t record) {
  THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file,
                               netcdf::NetcdfFile::Open(metadata->path, metadata->group));
  std::optional<netcdf::NetcdfFile> heights_file;
  if (!metadata->heights_path.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(heights_file, netcdf::NetcdfFile::Open(metadata->heights_path));
  }
  return std::make_unique<CfSource>(std::move(metadata), record, std::move(file),
                                    std::move(heights_file));
}

}  // namespace thunderhead::storm_files
