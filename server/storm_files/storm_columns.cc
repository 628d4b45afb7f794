#include "storm_files/storm_columns.h"

#include <utility>

#include "glm/common.hpp"

namespace thunderhead::storm_files {

StormColumns::StormColumns(const LayerDomain& domain, int stride)
    : resampling_(domain.Resampling()),
      stride_(stride),
      even_columns_(domain.StormColumns()),
      even_spacing_m_(domain.StormSpacing_m()),
      low_corner_m_(domain.middle_m - 0.5 * even_spacing_m_ * glm::dvec2(even_columns_)) {}

std::vector<float> StormColumns::Of(std::vector<float> values, Beyond beyond) const {
  if (resampling_ != nullptr) values = Resampled(*resampling_, values, beyond);
  return stride_ == 1 ? values : BlockMeans(values, even_columns_, stride_, beyond);
}

double StormColumns::KeepSum(std::vector<float>& values) const {
  double factor = 1.0;
  if (resampling_ != nullptr) {
    std::vector<float> resampled = Resampled(*resampling_, values, Beyond::kZero);
    factor = SumFactor(*resampling_, values, resampled);
    for (float& value : resampled) value *= static_cast<float>(factor);
    values = std::move(resampled);
  }
  if (stride_ > 1) values = BlockMeans(values, even_columns_, stride_, Beyond::kZero);
  return factor;
}

std::size_t StormColumns::NearestTo(const glm::ivec2& column) const {
  const glm::ivec2 even = glm::min(column * stride_ + stride_ / 2, even_columns_ - 1);
  const auto at = static_cast<std::size_t>(even.y) * static_cast<std::size_t>(even_columns_.x) +
                  static_cast<std::size_t>(even.x);
  return resampling_ != nullptr ? NearestColumn(*resampling_, at) : at;
}

std::vector<float> StormColumns::NearestOf(std::vector<float> values) const {
  if (values.empty() || (resampling_ == nullptr && stride_ == 1)) return values;
  const glm::ivec2 columns = Columns();
  std::vector<float> nearest;
  nearest.reserve(static_cast<std::size_t>(columns.x) * static_cast<std::size_t>(columns.y));
  for (int y = 0; y < columns.y; ++y) {
    for (int x = 0; x < columns.x; ++x) nearest.push_back(values[NearestTo({x, y})]);
  }
  return nearest;
}

}  // namespace thunderhead::storm_files
