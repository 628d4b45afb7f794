#include "storm_files/resampled_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace thunderhead::storm_files {
namespace {

// Returns `vector` turned counter-clockwise.
glm::dvec2 Turned(const glm::dvec2& vector, double angle_rad) {
  const double cosine = std::cos(angle_rad);
  const double sine = std::sin(angle_rad);
  return {cosine * vector.x - sine * vector.y, sine * vector.x + cosine * vector.y};
}

std::size_t ModelColumnCount(const EvenColumns& even) {
  return static_cast<std::size_t>(even.model_columns.x) *
         static_cast<std::size_t>(even.model_columns.y);
}

}  // namespace

std::vector<float> Resampled(const EvenColumns& even, const std::vector<float>& values,
                             Beyond beyond) {
  const std::size_t columns = ModelColumnCount(even);
  const std::size_t levels = values.size() / columns;
  // A model with one column along an axis has no neighbour there.
  const std::size_t east = even.model_columns.x > 1 ? 1 : 0;
  const std::size_t north =
      even.model_columns.y > 1 ? static_cast<std::size_t>(even.model_columns.x) : 0;
  std::vector<float> resampled;
  resampled.reserve(levels * even.from.size());
  for (std::size_t level = 0; level < levels; ++level) {
    const float* const layer = values.data() + level * columns;
    for (const FromColumn& from : even.from) {
      if (!from.inside && beyond == Beyond::kZero) {
        resampled.push_back(0.0F);
        continue;
      }
      const float* const at = layer + from.south_west;
      const float south = at[0] + from.east * (at[east] - at[0]);
      const float in_north = at[north] + from.east * (at[north + east] - at[north]);
      resampled.push_back(south + from.north * (in_north - south));
    }
  }
  return resampled;
}

std::size_t NearestColumn(const EvenColumns& even, std::size_t even_column) {
  const FromColumn& from = even.from[even_column];
  std::size_t column = from.south_west;
  if (from.east >= 0.5F && even.model_columns.x > 1) column += 1;
  if (from.north >= 0.5F && even.model_columns.y > 1) {
    column += static_cast<std::size_t>(even.model_columns.x);
  }
  return column;
}

std::vector<float> BlockMeans(const std::vector<float>& values, const glm::ivec2& columns,
                              int stride, Beyond beyond) {
  const glm::ivec2 blocks = (columns + stride - 1) / stride;
  const auto row = static_cast<std::size_t>(columns.x);
  const std::size_t level_size = row * static_cast<std::size_t>(columns.y);
  const std::size_t levels = values.size() / level_size;
  std::vector<float> means;
  means.reserve(levels * static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y));
  for (std::size_t level = 0; level < levels; ++level) {
    const float* const layer = values.data() + level * level_size;
    for (int block_y = 0; block_y < blocks.y; ++block_y) {
      const int end_y = std::min((block_y + 1) * stride, columns.y);
      for (int block_x = 0; block_x < blocks.x; ++block_x) {
        const int end_x = std::min((block_x + 1) * stride, columns.x);
        double sum = 0.0;
        for (int y = block_y * stride; y < end_y; ++y) {
          const float* const at = layer + static_cast<std::size_t>(y) * row;
          for (int x = block_x * stride; x < end_x; ++x) sum += at[x];
        }
        const int inside = (end_x - block_x * stride) * (end_y - block_y * stride);
        means.push_back(
            static_cast<float>(sum / (beyond == Beyond::kZero ? stride * stride : inside)));
      }
    }
  }
  return means;
}

double SumFactor(const EvenColumns& even, const std::vector<float>& values,
                 const std::vector<float>& resampled) {
  if (even.model_areas.empty()) return 1.0;
  const std::size_t columns = ModelColumnCount(even);
  double sum = 0.0;
  for (std::size_t first = 0; first < values.size(); first += columns) {
    for (std::size_t column = 0; column < columns; ++column) {
      sum += static_cast<double>(even.model_areas[column]) * values[first + column];
    }
  }
  const double resampled_sum = std::accumulate(resampled.begin(), resampled.end(), 0.0);
  return sum > 0.0 && resampled_sum > 0.0 ? sum / resampled_sum : 1.0;
}

glm::dvec2 AlongEvenAxes(const EvenColumns& even, const glm::dvec2& along_model_axes) {
  return even.Resampled() ? Turned(along_model_axes, even.grid_north_rad) : along_model_axes;
}

glm::dvec2 EastNorthAlongEvenAxes(const EvenColumns& even, const glm::dvec2& east_north) {
  return even.Resampled() ? east_north : Turned(east_north, -even.grid_north_rad);
}

}  // namespace thunderhead::storm_files
