// The ground's cover as a storm file has it: reflectance by colour and water for each column. Kept
// as bytes, as the device takes it. Knows no file.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/land_use.h"
#include "volume/grid.h"

namespace thunderhead::volume {

// A file's values for each column, x fastest; empty where it has none of a kind, NaN where missing.
struct LandColumns {
  physics::LandUseScheme scheme = physics::LandUseScheme::kUsgs;
  std::vector<float> land_use;  // classes, counted from 1
  std::vector<float> water;     // above 0.5: water; empty: by class
  std::vector<float> albedo;
  std::vector<float> green_percent;
  std::vector<float> snow_share;
};

struct LandSurface {
  // nx * ny texels, x fastest: reflectance by colour, encoded as sRGB, and the share of water.
  // Texels of water have the colour of land beside them, so that none shows between the two.
  std::vector<glm::u8vec4> texels;
  double mean_albedo = 0.0;          // of land and water
  glm::vec3 mean_reflectance{0.0F};  // of land

  bool Empty() const { return texels.empty(); }
};

// The surface of nx * ny columns with classes of land use.
LandSurface MakeLandSurface(const LandColumns& columns, const glm::ivec2& cells);

struct LandSample {
  glm::vec3 reflectance{0.0F};  // of the land
  float water = 0.0F;           // share
};

// At a place in world metres. Beyond the domain of `grid` the coast goes on as at its edge and the
// land takes its mean colour within some tens of cells (`kLandFades_cells`).
LandSample LandAt(const LandSurface& land, const RegularGrid& grid, const glm::dvec2& place_m);

inline constexpr float kLandFades_cells = 10.0F;  // by e
// The share of a cell over which a coast goes from land to water.
inline constexpr float kCoast_cells = 0.1F;

}  // namespace thunderhead::volume
