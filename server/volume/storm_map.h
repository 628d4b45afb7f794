// A map of a storm seen from above: the water paths of its columns at a limited resolution, and the
// place where each field is strongest. This code does not depend on files, scenes or GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The cell and the column in which a field is strongest. If the field is zero everywhere, all
// members are 0 and the positions have no meaning.
struct FieldPeak {
  std::size_t index = 0;              // into HydrometeorFields::fields
  float value = 0.0F;                 // largest value of a cell, in the unit of QuantityOf
  double kg_per_m3 = 0.0;             // mass per volume in that cell; 0 if the field is given as
                                      // extinction
  glm::dvec3 position_m{0.0};         // the cell's centre
  double column_kg_per_m2 = 0.0;      // largest water path of a column; the optical depth if the
                                      // field is given as extinction
  glm::dvec2 column_position_m{0.0};  // the column's centre
};

// A map of the domain in pixels of equal size. x runs fastest, from the west, then y from the
// south.
struct StormMap {
  glm::ivec2 size_px{0};
  std::vector<float> values;            // mean water path of each pixel in kg/m2; the optical depth
                                        // for extinction
  std::vector<float> terrain_height_m;  // mean height of each pixel; empty if not requested
  std::vector<FieldPeak> peaks;         // one for each field, in the fields' order
};

struct StormMapSettings {
  std::vector<std::size_t> fields;  // indices of the fields whose paths are added up
  int max_size_px = 1;              // maximum number of pixels along the longer side
  bool with_terrain = false;
};

StormMap MapOf(const HydrometeorFields& fields, const StormMapSettings& settings);

// Resamples a map of `from.x` by `from.y` values, x fastest, to `to.x` by `to.y` pixels. Each pixel
// is the mean over its area.
std::vector<double> Resampled(const std::vector<double>& values, const glm::ivec2& from,
                              const glm::ivec2& to);

}  // namespace thunderhead::volume
