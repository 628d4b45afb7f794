// The land cover in a storm file: reflectance by colour and water for each column. It is kept as
// bytes, the form that the device takes. This code does not depend on files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/land_use.h"
#include "volume/grid.h"

namespace thunderhead::volume {

// A file's values for each column, x fastest. An array is empty if the file lacks its values, and a
// missing value is NaN.
struct LandColumns {
  physics::LandUseScheme scheme = physics::LandUseScheme::kUsgs;
  std::vector<float> land_use;  // classes, counted from 1
  std::vector<float> water;     // above 0.5: water; empty: derived from the class
  std::vector<float> albedo;
  std::vector<float> green_percent;
  std::vector<float> snow_share;
};

struct LandSurface {
  // nx * ny texels, x fastest: reflectance by colour, encoded as sRGB, and the share of water.
  // Texels of water have the colour of neighbouring land, so that no other colour shows between the
  // two.
  std::vector<glm::u8vec4> texels;
  double mean_albedo = 0.0;          // mean over land and water
  glm::vec3 mean_reflectance{0.0F};  // mean over land

  bool Empty() const { return texels.empty(); }
};

// Makes the surface of nx * ny columns from classes of land use.
LandSurface MakeLandSurface(const LandColumns& columns, const glm::ivec2& cells);

struct LandSample {
  glm::vec3 reflectance{0.0F};  // reflectance of the land
  float water = 0.0F;           // share of water
};

// Returns the surface at a place in world metres. Beyond the domain of `grid` the coast continues
// like at its edge. The land fades to its mean colour within some tens of cells
// (`kLandFades_cells`).
LandSample LandAt(const LandSurface& land, const RegularGrid& grid, const glm::dvec2& place_m);

inline constexpr float kLandFades_cells = 10.0F;  // distance in which the difference falls to 1/e
// The share of a cell over which a coast changes from land to water.
inline constexpr float kCoast_cells = 0.1F;

}  // namespace thunderhead::volume
