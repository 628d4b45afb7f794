// Reflectances of the classes of land use. There are the 24 classes of the U.S. Geological Survey
// and the 21 classes of MODIS (modified IGBP), as numbered by WRF's LU_INDEX. The albedos are the
// summer albedos of WRF's LANDUSE.TBL.
#pragma once

#include "glm/vec3.hpp"

namespace thunderhead::physics {

enum class LandUseScheme { kUsgs, kModis };

struct LandUse {
  glm::vec3 hue{1.0F};  // linear sRGB of luminance 1
  float albedo = 0.2F;
  bool water = false;
  // True if the hue turns to that of dry plants and soil when few green plants cover the land.
  bool ripens = false;
};

// Returns class number `index`, counted from 1. Returns grassland for an unknown index.
LandUse LandUseOf(LandUseScheme scheme, int index);

// A model's state of the land in addition to its class. A value is NaN if the model does not give
// it.
struct LandState {
  float albedo = 0.0F;         // broadband, including snow; 0 or less, or over 1, is unknown
  float green_percent = 0.0F;  // percentage of the land that green plants cover
  float snow_share = 0.0F;     // share of the land that snow covers, 0 to 1
};

// Returns the land's reflectance in red, green and blue. Its luminance is the model's albedo. If
// that is unknown, it is the albedo of the class, mixed with that of snow.
glm::vec3 LandReflectance(const LandUse& use, const LandState& state);

}  // namespace thunderhead::physics
