// The medium for propagating light (light_medium.comp). It has one value for each cell and is linear between cells.
#include "common/medium_box.glsl"
#include "light_volume/bindings.glsl"

layout(binding = kLightMediumUnit) uniform sampler3D light_medium;
uniform float light_medium_per_m;  // extinction that a texel value of 1 stands for
