// Reflectances of the classes of land use: the 24 of the U.S. Geological Survey and the 21 of MODIS
// (modified IGBP), as numbered by WRF's LU_INDEX. The albedos are the summer albedos of WRF's
// LANDUSE.TBL.
#pragma once

#include "glm/vec3.hpp"

namespace thunderhead::physics {

enum class LandUseScheme { kUsgs, kModis };

struct LandUse {
  glm::vec3 hue{1.0F};  // linear sRGB of luminance 1
  float albedo = 0.2F;
  bool water = false;
  bool ripens = false;  // the hue fades to that of dry plants and soil if little is green
};

// Returns class `index`, counted from 1, or grassland for an unknown index.
LandUse LandUseOf(LandUseScheme scheme, int index);

// A model's state of the land in addition to its class. A value is NaN if the model has none.
struct LandState {
  float albedo = 0.0F;         // broadband, including snow; 0 counts as unknown
  float green_percent = 0.0F;  // share that green plants cover
  float snow_share = 0.0F;     // share that snow covers
};

// Returns the reflectance by colour of land. Its luminance is the albedo.
glm::vec3 LandReflectance(const LandUse& use, const LandState& state);

}  // namespace thunderhead::physics
