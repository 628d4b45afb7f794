// The medium for propagating light (light_medium.comp), with one value a cell and linear between cells.
#include "common/medium_box.glsl"
#include "light_volume/bindings.glsl"

layout(binding = kLightMediumUnit) uniform sampler3D light_medium;
uniform float light_medium_per_m;  // extinction of a texel value of 1
