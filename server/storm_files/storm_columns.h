// The columns of a storm's regular grid, and the values of a source's columns at them. Values are
// resampled if the source's columns are not even in true metres, and averaged over blocks if the
// stride is above 1.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "storm_files/even_columns.h"
#include "storm_files/layer_source.h"
#include "storm_files/resampled_columns.h"

namespace thunderhead::storm_files {

class StormColumns {
 public:
  // The domain's even columns must outlive this object.
  StormColumns(const LayerDomain& domain, int stride);

  glm::ivec2 Columns() const { return (even_columns_ + stride_ - 1) / stride_; }
  glm::dvec2 Spacing_m() const { return static_cast<double>(stride_) * even_spacing_m_; }
  // Returns the south-western corner of the first column. The last columns may reach beyond the
  // eastern and northern edge of the domain.
  glm::dvec2 LowCorner_m() const { return low_corner_m_; }

  // Returns values of the source's columns, of any number of levels, at the storm's columns.
  std::vector<float> Of(std::vector<float> values, Beyond beyond) const;
  // Replaces a concentration by its values at the storm's columns, as Of does. Multiplies it by a
  // factor that keeps its sum over the domain, and returns the factor.
  double KeepSum(std::vector<float>& values) const;
  // Returns the index of the source's column that is nearest to the middle of a storm's column.
  std::size_t NearestTo(const glm::ivec2& column) const;
  // Returns the values of the source's columns that are nearest to the storm's. An empty array
  // stays empty.
  std::vector<float> NearestOf(std::vector<float> values) const;

 private:
  const EvenColumns* const resampling_;  // null if the source's columns stay as they are
  const int stride_;
  const glm::ivec2 even_columns_;  // the columns of which blocks are averaged
  const glm::dvec2 even_spacing_m_;
  const glm::dvec2 low_corner_m_;
};

}  // namespace thunderhead::storm_files
