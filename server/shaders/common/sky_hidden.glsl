// The storm in a point's sky (air/sky_hidden.comp).
#include "common/bindings.glsl"

layout(binding = kSkyHiddenUnit) uniform sampler3D sky_hidden;

uniform vec3 hidden_scale;  // texture coordinates per metre
uniform vec3 hidden_offset;

// x: the share of the sky that the storm hides; y: the mean radiance that it sends in place of it to a point in its shadow,
// times pi, for an irradiance of 1 on level ground under the clear sky.
vec2 storm_in_sky(vec3 point_m) { return texture(sky_hidden, point_m * hidden_scale + hidden_offset).rg; }
