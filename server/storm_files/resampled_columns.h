// Resamples values of a model's columns to columns that are even in true metres. This code is pure
// arithmetic and does not depend on files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "storm_files/even_columns.h"

namespace thunderhead::storm_files {

// The values of even columns outside of the model's domain: 0, or those of the nearest place
// inside.
enum class Beyond { kZero, kNearest };

// Resampled and NearestColumn need columns that are resampled (EvenColumns::Resampled). Unless a
// comment says otherwise, `values` has a value for each of the model's columns, x fastest, or
// several levels of them.

// Returns the values at the even columns, interpolated bilinearly between the model's columns.
std::vector<float> Resampled(const EvenColumns& even, const std::vector<float>& values,
                             Beyond beyond);

// Returns the index of the model's column nearest to an even column.
std::size_t NearestColumn(const EvenColumns& even, std::size_t even_column);

// Returns the means of blocks of `stride` x `stride` columns, for any number of levels of `columns`
// columns. Blocks at the eastern and northern edge may reach beyond the columns. With
// Beyond::kZero the values there count as 0, so the sum over all columns is kept, apart from the
// factor stride^2. With Beyond::kNearest only the columns inside count.
std::vector<float> BlockMeans(const std::vector<float>& values, const glm::ivec2& columns,
                              int stride, Beyond beyond);

// Returns the factor by which `resampled` must be multiplied to have the sum of `values`, in which
// each column is weighted by its area. Interpolation between columns that are farther apart, or
// less far, than the even columns changes the sum a little. Returns 1 if a sum is 0, or if the
// areas of the model's columns are not known.
double SumFactor(const EvenColumns& even, const std::vector<float>& values,
                 const std::vector<float>& resampled);

// Returns a wind along the model's axes at the middle of the domain as a wind along the axes of the
// even columns.
glm::dvec2 AlongEvenAxes(const EvenColumns& even, const glm::dvec2& along_model_axes);

// Returns a wind to the east and to the north as a wind along the axes of the even columns.
glm::dvec2 EastNorthAlongEvenAxes(const EvenColumns& even, const glm::dvec2& east_north);

}  // namespace thunderhead::storm_files
