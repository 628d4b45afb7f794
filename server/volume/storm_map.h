// A storm from above, in numbers: water paths of its columns as a map of limited size, and where
// each field is strongest. Knows no files, scene or GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Where a field is strongest; zero and without places if it is zero everywhere.
struct FieldPeak {
  std::size_t index = 0;              // into HydrometeorFields::fields
  float value = 0.0F;                 // the largest of a cell, in the unit of QuantityOf
  double kg_per_m3 = 0.0;             // in that cell; 0 of extinction
  glm::dvec3 position_m{0.0};         // of its middle
  double column_kg_per_m2 = 0.0;      // the largest of a column; optical depth of extinction
  glm::dvec2 column_position_m{0.0};  // of its middle
};

// Pixels of equal size cover the domain; x runs fastest, from west, then y from south.
struct StormMap {
  glm::ivec2 size_px{0};
  std::vector<float> values;            // mean paths, kg/m2 (optical depth of extinction)
  std::vector<float> terrain_height_m;  // means; empty if not asked for
  std::vector<FieldPeak> peaks;         // of every field, in their order
};

struct StormMapSettings {
  std::vector<std::size_t> fields;  // whose paths are added up, as indices
  int max_size_px = 1;              // of the longer side
  bool with_terrain = false;
};

StormMap MapOf(const HydrometeorFields& fields, const StormMapSettings& settings);

// Means over `size` pixels of equal size, by area, of a map of nx by ny values, x fastest.
std::vector<double> Resampled(const std::vector<double>& values, const glm::ivec2& from,
                              const glm::ivec2& to);

}  // namespace thunderhead::volume
