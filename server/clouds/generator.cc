#include "clouds/generator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/vector_relational.hpp"

namespace thunderhead::clouds {
namespace {

constexpr int kMaxCellsAlong = 4096;
constexpr std::size_t kMaxCells = std::size_t{1} << 28;
constexpr int kMaxOctaves = 16;
constexpr double kMaxWater_kg_per_m3 = 0.05;

// The smallest allowed lattice cell of the finest octave, in cells of the grid. Finer detail is not
// visible, and its lattice would need much memory.
constexpr double kFinestDetail_cells = 0.25;

// Returns the error for a parameter that is out of range. `field` is the parameter's name on the
// command line and in requests, or empty if it has none there.
absl::Status Wrong(const std::string& what, double value, const std::string& wanted,
                   const std::string& field = "") {
  return base::WithDetails(
      absl::InvalidArgumentError(absl::StrCat(what, " is ", value, "; it must be ", wanted)),
      {.reason = "VALUE_OUT_OF_RANGE", .field = field});
}

absl::Status CheckGrid(const volume::RegularGrid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.cells[axis] < 1 || grid.cells[axis] > kMaxCellsAlong) {
      return Wrong("the number of cells along an axis", grid.cells[axis],
                   absl::StrCat("from 1 to ", kMaxCellsAlong));
    }
    if (!(grid.spacing_m[axis] > 0.0 && std::isfinite(grid.spacing_m[axis]))) {
      return Wrong("the size of a cell in m", grid.spacing_m[axis], "above 0");
    }
  }
  if (grid.CellCount() > kMaxCells) {
    return Wrong("the number of cells", static_cast<double>(grid.CellCount()),
                 absl::StrCat("at most ", kMaxCells));
  }
  return absl::OkStatus();
}

absl::Status CheckNoise(const CloudShape& shape) {
  const NoiseParameters& noise = shape.noise;
  if (noise.octaves < 1 || noise.octaves > kMaxOctaves) {
    return Wrong("the number of octaves", noise.octaves, absl::StrCat("from 1 to ", kMaxOctaves),
                 "octaves");
  }
  if (!(noise.persistence > 0.0 && noise.persistence <= 1.0)) {
    return Wrong("the persistence", noise.persistence, "above 0 and at most 1", "persistence");
  }
  if (!(shape.feature_m > 0.0 && std::isfinite(shape.feature_m))) {
    return Wrong("the feature size in m", shape.feature_m, "above 0", "feature_size_m");
  }
  const glm::dvec3& spacing_m = shape.grid.spacing_m;
  const double cell_m = std::max({spacing_m.x, spacing_m.y, spacing_m.z});
  const double finest_m = std::ldexp(shape.feature_m, 1 - noise.octaves);
  if (finest_m < kFinestDetail_cells * cell_m) {
    return base::WithDetails(
        absl::InvalidArgumentError(absl::StrCat(
            "the finest of ", noise.octaves, " octaves is ", finest_m, " m, too fine for cells of ",
            cell_m, " m; give fewer octaves, a larger feature size or smaller cells")),
        {.reason = "DETAIL_TOO_FINE", .field = "octaves"});
  }
  return absl::OkStatus();
}

absl::Status CheckEllipsoid(const Ellipsoid& ellipsoid) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool finite =
        std::isfinite(ellipsoid.centre_m[axis]) && std::isfinite(ellipsoid.rotation_deg[axis]);
    if (!finite)
      return absl::InvalidArgumentError("an ellipsoid's place or rotation is not finite");
    if (!(ellipsoid.radii_m[axis] > 0.0 && std::isfinite(ellipsoid.radii_m[axis]))) {
      return Wrong("an ellipsoid's radius in m", ellipsoid.radii_m[axis], "above 0", "ellipsoids");
    }
  }
  return absl::OkStatus();
}

struct Range {
  int first = 0;
  int last = -1;
};

// Returns the cells whose centres are within `half_m` of `centre_m` along `axis`.
Range CellsWithin(const volume::RegularGrid& grid, int axis, double centre_m, double half_m) {
  const double low = (centre_m - half_m - grid.low_corner_m[axis]) / grid.spacing_m[axis] - 0.5;
  const double high = (centre_m + half_m - grid.low_corner_m[axis]) / grid.spacing_m[axis] - 0.5;
  const double last = grid.cells[axis] - 1;
  return {static_cast<int>(std::clamp(std::floor(low), 0.0, last + 1.0)),
          static_cast<int>(std::clamp(std::ceil(high), -1.0, last))};
}

double Middle_m(const volume::RegularGrid& grid, int axis, int cell) {
  return grid.low_corner_m[axis] + (cell + 0.5) * grid.spacing_m[axis];
}

// Computes the modulation of the noise in slice `z`: the maximum of all ellipsoids' quadrics, or 0
// outside all ellipsoids.
void Modulate(const volume::RegularGrid& grid, const std::vector<Quadric>& quadrics, int z,
              std::vector<double>* modulation) {
  std::fill(modulation->begin(), modulation->end(), 0.0);
  const double z_m = Middle_m(grid, 2, z);
  for (const Quadric& quadric : quadrics) {
    const glm::dvec3& centre_m = quadric.Centre_m();
    const glm::dvec3& half_m = quadric.HalfExtent_m();
    if (std::abs(z_m - centre_m.z) > half_m.z) continue;
    const Range columns = CellsWithin(grid, 0, centre_m.x, half_m.x);
    const Range rows = CellsWithin(grid, 1, centre_m.y, half_m.y);
    for (int y = rows.first; y <= rows.last; ++y) {
      for (int x = columns.first; x <= columns.last; ++x) {
        const double value = quadric.Value({Middle_m(grid, 0, x), Middle_m(grid, 1, y), z_m});
        double& largest = (*modulation)[grid.Offset(x, y, 0)];
        largest = std::max(largest, value);
      }
    }
  }
}

NoiseAxis AxisOf(const CloudShape& shape, int axis) {
  return {Middle_m(shape.grid, axis, 0) / shape.feature_m,
          shape.grid.spacing_m[axis] / shape.feature_m, shape.grid.cells[axis]};
}

}  // namespace

absl::Status CheckShape(const CloudShape& shape) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckGrid(shape.grid));
  THUNDERHEAD_RETURN_IF_ERROR(CheckNoise(shape));
  if (!(shape.threshold >= 0.0 && shape.threshold < 1.0)) {
    return Wrong("the threshold", shape.threshold, "at least 0 and below 1", "threshold");
  }
  if (!(shape.dynamics > 0.0 && shape.dynamics <= 1.0)) {
    return Wrong("the dynamics", shape.dynamics, "above 0 and at most 1", "dynamics");
  }
  if (!(shape.water_kg_per_m3 > 0.0 && shape.water_kg_per_m3 <= kMaxWater_kg_per_m3)) {
    return Wrong("the liquid water in g/m3", 1e3 * shape.water_kg_per_m3,
                 absl::StrCat("above 0 and at most ", 1e3 * kMaxWater_kg_per_m3),
                 "water_kg_per_m3");
  }
  if (shape.base_m.has_value() && !std::isfinite(*shape.base_m)) {
    return Wrong("the height of the base in m", *shape.base_m, "a finite number", "base_m");
  }
  if (shape.ellipsoids.empty()) return absl::InvalidArgumentError("a cloud needs an ellipsoid");
  for (const Ellipsoid& ellipsoid : shape.ellipsoids) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckEllipsoid(ellipsoid));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<float>> Generate(const CloudShape& shape,
                                            const GenerateObserver& observer,
                                            const std::stop_token& stop) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckShape(shape));
  const volume::RegularGrid& grid = shape.grid;
  const std::vector<Quadric> quadrics(shape.ellipsoids.begin(), shape.ellipsoids.end());
  NoiseSlices noise(shape.noise, AxisOf(shape, 0), AxisOf(shape, 1));
  const std::size_t columns = grid.Offset(0, 0, 1);
  std::vector<double> modulation(columns);
  std::vector<float> water_kg_per_m3(grid.CellCount(), 0.0F);
  bool any = false;
  for (int z = 0; z < grid.cells.z; ++z) {
    if (stop.stop_requested()) return absl::CancelledError("stopped before the cloud was done");
    if (observer) observer(static_cast<double>(z) / grid.cells.z);
    const double z_m = Middle_m(grid, 2, z);
    if (shape.base_m.has_value() && z_m < *shape.base_m) continue;
    Modulate(grid, quadrics, z, &modulation);
    if (*std::max_element(modulation.begin(), modulation.end()) <= 0.0) continue;
    const std::vector<double>& values = noise.At(z_m / shape.feature_m);
    float* to = water_kg_per_m3.data() + grid.Offset(0, 0, z);
    for (std::size_t i = 0; i < columns; ++i) {
      const double density = values[i] * modulation[i];
      if (density <= 0.0 || density < shape.threshold) continue;
      to[i] = static_cast<float>(shape.dynamics * density * shape.water_kg_per_m3);
      any = true;
    }
  }
  if (any) return water_kg_per_m3;
  return base::WithDetails(
      absl::InvalidArgumentError(
          absl::StrCat("no cell holds any cloud: nowhere in the domain is the density above the "
                       "threshold ",
                       shape.threshold, "; lower it, or move the ellipsoids")),
      {.reason = "CLOUD_EMPTY", .field = "threshold"});
}

}  // namespace thunderhead::clouds
