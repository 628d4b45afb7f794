// The correction of a ray's radiance (renderers::LightCorrection) by the ray's direction and by a place in the medium's
// box. Coordinates of the place are from 0 to 1.
#include "light_volume/bindings.glsl"

layout(binding = kCorrectionRedUnit) uniform sampler3D correction_red;
layout(binding = kCorrectionGreenUnit) uniform sampler3D correction_green;
layout(binding = kCorrectionBlueUnit) uniform sampler3D correction_blue;

vec3 corrected(vec3 radiance, vec3 place, vec3 direction) {
  vec4 by = vec4(1.0, direction);
  return radiance * max(vec3(dot(texture(correction_red, place), by), dot(texture(correction_green, place), by),
                             dot(texture(correction_blue, place), by)),
                        vec3(0.0));
}
