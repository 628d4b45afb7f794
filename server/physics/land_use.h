// Reflectances of the classes of land use: the 24 of the U.S. Geological Survey and the 21 of MODIS
// (modified IGBP) that WRF's LU_INDEX counts, with the summer albedos of WRF's LANDUSE.TBL.
#pragma once

#include "glm/vec3.hpp"

namespace thunderhead::physics {

enum class LandUseScheme { kUsgs, kModis };

struct LandUse {
  glm::vec3 hue{1.0F};  // linear sRGB of luminance 1
  float albedo = 0.2F;
  bool water = false;
  bool ripens = false;  // its hue fades to that of dry plants and soil where little is green
};

// Class `index`, from 1 on; of an unknown one, grassland.
LandUse LandUseOf(LandUseScheme scheme, int index);

// A model's state of the land besides its class; NaN where it has none.
struct LandState {
  float albedo = 0.0F;         // broadband, with its snow; 0 counts as unknown
  float green_percent = 0.0F;  // share that green plants cover
  float snow_share = 0.0F;     // share that snow covers
};

// Reflectance by colour of land, whose luminance is its albedo.
glm::vec3 LandReflectance(const LandUse& use, const LandState& state);

}  // namespace thunderhead::physics
