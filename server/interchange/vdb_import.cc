#include "interchange/vdb_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "base/version.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::interchange {
namespace {

absl::Status Refused(const VdbVolume& volume, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat("the grid '", volume.grid, "' ", why));
}

// Turns a vector of the file's world such that z is up.
glm::dvec3 Turned(const glm::dvec3& v, UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return {v.y, v.z, v.x};
    case UpAxis::kY:
      return {v.x, -v.z, v.y};
    case UpAxis::kZ:
      break;
  }
  return v;
}

// The axes of a volume, after it was turned.
struct Axes {
  glm::ivec3 of{0};                // the axis of the volume (0, 1, 2: i, j, k) along x, y and z
  std::array<bool, 3> reversed{};  // true if the volume's axis points against x, y or z
};

// Returns the axis (0, 1, 2) along which `step` points, or nothing if it is along none.
std::optional<int> AxisAlong(const glm::dvec3& step) {
  // The tolerance is needed because the transform of a grid that was turned by a right angle has
  // rounding errors.
  constexpr double kSlack = 1e-6;
  const double length = glm::length(step);
  if (!std::isfinite(length) || !(length > 0.0)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(step[axis]) >= (1.0 - kSlack * kSlack) * length) return axis;
  }
  return std::nullopt;
}

absl::StatusOr<Axes> AxesOf(const VdbVolume& volume, const std::array<glm::dvec3, 3>& steps_m) {
  Axes axes;
  std::array<bool, 3> has{};
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3& step_m = steps_m[static_cast<std::size_t>(i)];
    const std::optional<int> axis = AxisAlong(step_m);
    if (!axis.has_value() || has[static_cast<std::size_t>(*axis)]) {
      return Refused(volume,
                     "is rotated or sheared against the axes of its world; resample it to a grid "
                     "along these axes");
    }
    has[static_cast<std::size_t>(*axis)] = true;
    axes.of[*axis] = i;
    axes.reversed[static_cast<std::size_t>(*axis)] = step_m[*axis] < 0.0;
  }
  return axes;
}

// Returns the grid of the turned volume. A grid has at least two cells along each axis, because a
// file with one cell does not say how thick it is.
volume::RegularGrid GridOf(const VdbVolume& volume, const glm::dvec3& first_m,
                           const std::array<glm::dvec3, 3>& steps_m, const Axes& axes) {
  volume::RegularGrid grid;
  for (int axis = 0; axis < 3; ++axis) {
    const double step_m = steps_m[static_cast<std::size_t>(axes.of[axis])][axis];
    const int count = volume.voxels[axes.of[axis]];
    grid.cells[axis] = std::max(count, 2);
    grid.spacing_m[axis] = std::abs(step_m);
    grid.low_corner_m[axis] =
        std::min(first_m[axis], first_m[axis] + (count - 1) * step_m) - 0.5 * std::abs(step_m);
  }
  return grid;
}

// Copies the values to the turned grid as extinction (1/m).
absl::StatusOr<std::vector<float>> TurnedValues(const VdbVolume& volume, const Axes& axes,
                                                const volume::RegularGrid& grid,
                                                double extinction_per_m) {
  const auto& voxels = volume.voxels;
  const std::array<std::int64_t, 3> strides = {1, voxels.x, std::int64_t{voxels.x} * voxels.y};
  std::int64_t first = 0;
  std::array<std::int64_t, 3> step{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    const auto of = static_cast<std::size_t>(axes.of[axis]);
    step[at] = axes.reversed[at] ? -strides[of] : strides[of];
    if (axes.reversed[at]) first += (voxels[axes.of[axis]] - 1) * strides[of];
  }
  std::vector<float> values(grid.CellCount(), 0.0F);
  const glm::ivec3 count(voxels[axes.of.x], voxels[axes.of.y], voxels[axes.of.z]);
  float largest = 0.0F;
  for (int z = 0; z < count.z; ++z) {
    for (int y = 0; y < count.y; ++y) {
      const std::int64_t row = first + z * step[2] + y * step[1];
      float* const to = values.data() + grid.Offset(0, y, z);
      for (int x = 0; x < count.x; ++x) {
        const float value = volume.values[static_cast<std::size_t>(row + x * step[0])];
        const double each_per_m = value * extinction_per_m;
        if (!(value >= 0.0F && each_per_m <= std::numeric_limits<float>::max())) {
          return Refused(volume, absl::StrCat("has the value ", value,
                                              ", and a density is finite and not negative"));
        }
        to[x] = static_cast<float>(each_per_m);
        largest = std::max(largest, to[x]);
      }
    }
  }
  if (largest > 0.0F) return values;
  return Refused(volume, "has no value above 0; give another");
}

absl::Status CheckPlace(const VdbVolume& volume, const volume::RegularGrid& grid) {
  constexpr double kSmallest_m = 1e-3;
  constexpr double kLargest_m = 1e6;
  constexpr double kFarthest_m = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing_m = grid.spacing_m[axis];
    if (!(spacing_m >= kSmallest_m && spacing_m <= kLargest_m)) {
      return Refused(volume,
                     absl::StrFormat("has voxels of %g m, and 1 mm to 1000 km can be shown; "
                                     "correct --metres-per-unit",
                                     spacing_m));
    }
    if (!(std::abs(grid.low_corner_m[axis]) <= kFarthest_m)) {
      return Refused(volume, absl::StrFormat("is %g m from the origin of its world; move it there",
                                             grid.low_corner_m[axis]));
    }
  }
  if (grid.low_corner_m.z >= 0.0) return absl::OkStatus();
  return Refused(volume,
                 absl::StrFormat("begins at the height %g m, which is below sea level; give "
                                 "--base, the height in m at which it should begin",
                                 grid.low_corner_m.z));
}

std::string CommentOf(const VdbVolume& volume, const ImportOptions& options) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  std::string comment = absl::StrFormat(
      "grid %s, up %s, %.9g m per unit of length, extinction %.9g m-1 per unit", volume.grid,
      kNames[static_cast<int>(options.up)], options.metres_per_unit, options.extinction_per_m);
  if (options.base_m.has_value()) absl::StrAppendFormat(&comment, ", base %.9g m", *options.base_m);
  return comment;
}

}  // namespace

absl::StatusOr<storm_files::CfCloud> CloudOf(const VdbVolume& volume,
                                             const ImportOptions& options) {
  const glm::dvec3 first_m = options.metres_per_unit * Turned(volume.first, options.up);
  std::array<glm::dvec3, 3> steps_m = volume.steps;
  for (glm::dvec3& step : steps_m) step = options.metres_per_unit * Turned(step, options.up);
  THUNDERHEAD_ASSIGN_OR_RETURN(const Axes axes, AxesOf(volume, steps_m));
  storm_files::CfCloud cloud;
  cloud.grid = GridOf(volume, first_m, steps_m, axes);
  if (options.base_m.has_value()) cloud.grid.low_corner_m.z = *options.base_m;
  THUNDERHEAD_RETURN_IF_ERROR(CheckPlace(volume, cloud.grid));
  THUNDERHEAD_RETURN_IF_ERROR(base::CountThatFits(absl::StrCat("the grid '", volume.grid, "'"),
                                                  {cloud.grid.CellCount()}, sizeof(float))
                                  .status());
  cloud.quantity = volume::Quantity::kExtinction;
  THUNDERHEAD_ASSIGN_OR_RETURN(cloud.values,
                               TurnedValues(volume, axes, cloud.grid, options.extinction_per_m));
  cloud.source = absl::StrCat("thunderhead ", base::Version(), " import-vdb");
  cloud.comment = CommentOf(volume, options);
  return cloud;
}

}  // namespace thunderhead::interchange
