#include "storm_files/wind_motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>

#include "glm/geometric.hpp"
#include "volume/air_motion.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kSteeringDepth_m = 6e3;
constexpr float kEnergyOfDeformation = 0.4F;  // square root of the energy, divided by l |D|: 0.2^2
                                              // / 0.1

// Values at the centres of cells, for computing derivatives.
struct Centred {
  const std::vector<float>& values;
  glm::ivec3 cells;

  float At(int x, int y, int z) const {
    x = std::clamp(x, 0, cells.x - 1);
    y = std::clamp(y, 0, cells.y - 1);
    z = std::clamp(z, 0, cells.z - 1);
    return values[(static_cast<std::size_t>(z) * static_cast<std::size_t>(cells.y) +
                   static_cast<std::size_t>(y)) *
                      static_cast<std::size_t>(cells.x) +
                  static_cast<std::size_t>(x)];
  }
};

// Returns for each cell the mean of the values on its two faces along `axis`.
std::vector<float> MiddlesOf(const std::vector<float>& faces, const glm::ivec3& cells, int axis) {
  glm::ivec3 size = cells;
  size[axis] += 1;
  const auto width = static_cast<std::size_t>(size.x);
  const auto layer = width * static_cast<std::size_t>(size.y);
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? width : layer;
  std::vector<float> middles;
  middles.reserve(static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
                  static_cast<std::size_t>(cells.z));
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      const float* row =
          faces.data() + static_cast<std::size_t>(z) * layer + static_cast<std::size_t>(y) * width;
      for (int x = 0; x < cells.x; ++x) middles.push_back(0.5F * (row[x] + row[x + stride]));
    }
  }
  return middles;
}

// Distances between the centres of a cell's neighbours.
struct Spans {
  float x_m;
  float y_m;
  float z_m;
};

glm::vec3 GradientAt(const Centred& component, const glm::ivec3& cell, const Spans& spans) {
  const auto [x, y, z] = std::tuple(cell.x, cell.y, cell.z);
  return {(component.At(x + 1, y, z) - component.At(x - 1, y, z)) / spans.x_m,
          (component.At(x, y + 1, z) - component.At(x, y - 1, z)) / spans.y_m,
          (component.At(x, y, z + 1) - component.At(x, y, z - 1)) / spans.z_m};
}

// Returns |D|^2 = 2 S_ij S_ij.
float DeformationSquared(const glm::vec3& u, const glm::vec3& v, const glm::vec3& w) {
  const float xy = u.y + v.x;
  const float xz = u.z + w.x;
  const float yz = v.z + w.y;
  return 2.0F * (u.x * u.x + v.y * v.y + w.z * w.z) + xy * xy + xz * xz + yz * yz;
}

// Returns the mean height, weighted by mass, of all frozen hydrometeors (if `frozen`) or of cloud
// water.
std::optional<double> MeanHeight_m(const volume::HydrometeorFields& fields, bool frozen) {
  double mass = 0.0;
  double moment = 0.0;
  const volume::RegularGrid& grid = fields.grid;
  const std::size_t layer = grid.Offset(0, 0, 1);
  for (const volume::HydrometeorField& field : fields.fields) {
    const bool cloud = field.hydrometeor == physics::Hydrometeor::kCloud;
    const bool rain = field.hydrometeor == physics::Hydrometeor::kRain;
    if (field.concentration_kg_per_m3.empty() || (frozen ? cloud || rain : !cloud)) continue;
    for (int z = 0; z < grid.cells.z; ++z) {
      const float* first =
          field.concentration_kg_per_m3.data() + static_cast<std::size_t>(z) * layer;
      const double sum = std::accumulate(first, first + layer, 0.0);
      mass += sum;
      moment += sum * (grid.low_corner_m.z + (z + 0.5) * grid.spacing_m.z);
    }
  }
  if (mass <= 0.0) return std::nullopt;
  return moment / mass;
}

// Returns the wind of the level that contains `height_m`.
glm::dvec2 WindAt(double height_m, const std::vector<glm::dvec2>& winds,
                  const std::vector<double>& interface_height_m) {
  std::size_t level = 0;
  while (level + 1 < winds.size() && interface_height_m[level + 1] < height_m) ++level;
  return winds[level];
}

}  // namespace

Wind WindInCells(const ModelWind& wind, const std::vector<float>& interface_height_m) {
  const auto in_cells = [&wind](const std::vector<float>& values, int axis) {
    return wind.on_faces ? MiddlesOf(values, wind.cells, axis) : values;
  };
  return {wind.cells,
          wind.dx_m,
          wind.dy_m,
          in_cells(wind.u_m_per_s, 0),
          in_cells(wind.v_m_per_s, 1),
          in_cells(wind.w_m_per_s, 2),
          MiddlesOf(interface_height_m, wind.cells, 2)};
}

std::vector<float> EnergyOfDeformation(const Wind& wind) {
  const glm::ivec3& cells = wind.cells;
  const Centred u{wind.u_m_per_s, cells};
  const Centred v{wind.v_m_per_s, cells};
  const Centred w{wind.w_m_per_s, cells};
  const Centred height_m{wind.height_m, cells};
  const auto between = [](int at, int count) {
    return static_cast<float>(std::min(at + 1, count - 1) - std::max(at - 1, 0));
  };
  const auto dx_m = static_cast<float>(wind.dx_m);
  const auto dy_m = static_cast<float>(wind.dy_m);
  std::vector<float> energy;
  energy.reserve(wind.u_m_per_s.size());
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) {
        const float span_z_m = height_m.At(x, y, z + 1) - height_m.At(x, y, z - 1);
        const Spans spans{std::max(between(x, cells.x), 1.0F) * dx_m,
                          std::max(between(y, cells.y), 1.0F) * dy_m, span_z_m};
        const float depth_m = span_z_m / std::max(between(z, cells.z), 1.0F);
        const glm::ivec3 cell(x, y, z);
        const float squared = DeformationSquared(
            GradientAt(u, cell, spans), GradientAt(v, cell, spans), GradientAt(w, cell, spans));
        const float length_m = std::cbrt(dx_m * dy_m * depth_m);
        const float e = kEnergyOfDeformation * kEnergyOfDeformation * length_m * length_m * squared;
        energy.push_back(std::isfinite(e) ? e : 0.0F);
      }
    }
  }
  return energy;
}

std::vector<float> LayerMeans(const std::vector<float>& at_interfaces, int levels,
                              std::size_t columns) {
  std::vector<float> means(static_cast<std::size_t>(levels) * columns);
  for (std::size_t i = 0; i < means.size(); ++i) {
    means[i] = 0.5F * (at_interfaces[i] + at_interfaces[i + columns]);
  }
  return means;
}

std::vector<double> LevelMeans(const std::vector<float>& values, int levels) {
  const std::size_t count = values.size() / static_cast<std::size_t>(levels);
  std::vector<double> means;
  for (std::size_t first = 0; first < values.size(); first += count) {
    double sum = 0.0;
    double present = 0.0;
    for (std::size_t i = first; i < first + count; ++i) {
      if (!std::isfinite(values[i])) continue;
      sum += static_cast<double>(values[i]);
      present += 1.0;
    }
    means.push_back(sum / present);
  }
  return means;
}

std::vector<glm::dvec2> MeanWinds(const std::vector<float>& u_m_per_s,
                                  const std::vector<float>& v_m_per_s, int levels) {
  const std::vector<double> u = LevelMeans(u_m_per_s, levels);
  const std::vector<double> v = LevelMeans(v_m_per_s, levels);
  std::vector<glm::dvec2> winds;
  for (std::size_t level = 0; level < u.size(); ++level) {
    winds.emplace_back(std::isnan(u[level]) ? 0.0 : u[level],
                       std::isnan(v[level]) ? 0.0 : v[level]);
  }
  return winds;
}

glm::dvec2 SteeringWind_m_per_s(const std::vector<glm::dvec2>& winds,
                                const std::vector<double>& interface_height_m) {
  const double top_m = interface_height_m[0] + kSteeringDepth_m;
  glm::dvec2 sum(0.0);
  double depth_m = 0.0;
  for (std::size_t level = 0; level < winds.size(); ++level) {
    const double thickness_m =
        std::min(interface_height_m[level + 1], top_m) - interface_height_m[level];
    // Levels below the ground have no thickness.
    if (!(thickness_m > 0.0)) continue;
    sum += thickness_m * winds[level];
    depth_m += thickness_m;
  }
  const glm::dvec2 mean = depth_m > 0.0 ? sum / depth_m : glm::dvec2(0.0);
  return glm::length(mean) <= volume::kMaxSteering_m_per_s ? mean : glm::dvec2(0.0);
}

glm::dvec2 Shear_m_per_s(const volume::HydrometeorFields& fields,
                         const std::vector<glm::dvec2>& winds,
                         const std::vector<double>& interface_height_m) {
  const std::optional<double> cloud_m = MeanHeight_m(fields, false);
  const std::optional<double> ice_m = MeanHeight_m(fields, true);
  if (!cloud_m.has_value() || !ice_m.has_value()) return glm::dvec2(0.0);
  return WindAt(*ice_m, winds, interface_height_m) - WindAt(*cloud_m, winds, interface_height_m);
}

}  // namespace thunderhead::storm_files
