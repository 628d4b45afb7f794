// A storm from above, in numbers: water paths of its columns as a map of limited size, and the
// places where each field is strongest. This code does not depend on files, scenes or GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The places where a field is strongest. A field that is zero everywhere has zeros and no places.
struct FieldPeak {
  std::size_t index = 0;              // into HydrometeorFields::fields
  float value = 0.0F;                 // largest value of a cell, in the unit of QuantityOf
  double kg_per_m3 = 0.0;             // mass in that cell; 0 for extinction
  glm::dvec3 position_m{0.0};         // the cell's centre
  double column_kg_per_m2 = 0.0;      // largest value of a column; optical depth for extinction
  glm::dvec2 column_position_m{0.0};  // the column's centre
};

// A map of the domain in pixels of equal size. x runs fastest, from the west, then y from the
// south.
struct StormMap {
  glm::ivec2 size_px{0};
  std::vector<float> values;            // mean paths, kg/m2 (for extinction optical depths)
  std::vector<float> terrain_height_m;  // means; empty if not requested
  std::vector<FieldPeak> peaks;         // one for each field, in the fields' order
};

struct StormMapSettings {
  std::vector<std::size_t> fields;  // indices of the fields whose paths are added up
  int max_size_px = 1;              // pixels along the longer side
  bool with_terrain = false;
};

StormMap MapOf(const HydrometeorFields& fields, const StormMapSettings& settings);

// Returns area means over `size` pixels of equal size, from a map of nx by ny values, x fastest.
std::vector<double> Resampled(const std::vector<double>& values, const glm::ivec2& from,
                              const glm::ivec2& to);

}  // namespace thunderhead::volume
