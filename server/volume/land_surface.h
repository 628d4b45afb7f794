// The land cover of a storm file: the reflectance of the land in three colours, and water or land,
// for each column. The values are bytes in the texture's format. This code does not depend on
// files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"
#include "physics/land_use.h"
#include "volume/grid.h"

namespace thunderhead::volume {

// A file's land values, one for each column, x fastest. An array is empty if the file lacks the
// variable. A missing value is NaN.
struct LandColumns {
  physics::LandUseScheme scheme = physics::LandUseScheme::kUsgs;
  std::vector<float> land_use;  // index of the land-use class, counted from 1
  std::vector<float> water;     // a column with a value above 0.5 is water; if empty, the land-use
                                // class decides
  std::vector<float> albedo;
  std::vector<float> green_percent;
  std::vector<float> snow_share;
};

struct LandSurface {
  // nx * ny texels, x fastest: reflectance in red, green and blue, encoded as sRGB, and the share
  // of water (0 or 255). Texels of water have the colour of neighbouring land, so that
  // interpolation between land and water shows no other colour.
  std::vector<glm::u8vec4> texels;
  double mean_albedo = 0.0;          // mean albedo of all columns, land and water
  glm::vec3 mean_reflectance{0.0F};  // mean reflectance of the land columns

  bool Empty() const { return texels.empty(); }
};

// Makes the surface of `cells.x` times `cells.y` columns from their land-use classes and other
// values.
LandSurface MakeLandSurface(const LandColumns& columns, const glm::ivec2& cells);

struct LandSample {
  glm::vec3 reflectance{0.0F};  // reflectance of the land
  float water = 0.0F;           // share of water, from 0 (land) to 1 (water)
};

// Returns the surface at a place in world metres. Beyond the domain of `grid`, water and land are
// those of the nearest edge. There the land's colour fades to the mean colour within some tens of
// cells (`kLandFades_cells`).
LandSample LandAt(const LandSurface& land, const RegularGrid& grid, const glm::dvec2& place_m);

inline constexpr float kLandFades_cells = 10.0F;  // distance in which the difference from the mean
                                                  // colour falls to 1/e
// The share of a cell over which a coast changes from land to water.
inline constexpr float kCoast_cells = 0.1F;

}  // namespace thunderhead::volume
