// The place in the picture of a pixel's ray. `position` ranges from (-1, -1) at the lower left to (1, 1) at the upper
// right. Call begin_place first. With the variant CHOSEN, the rays are those of renderers::ChosenRays instead of the
// picture's pixels.
#include "common/bindings.glsl"

#if CHOSEN
layout(binding = kChosenPlacesUnit) uniform sampler2D chosen_places;

vec2 position;

void begin_place() { position = texelFetch(chosen_places, ivec2(gl_FragCoord.xy), 0).rg; }

// Returns the texel of this pixel's ray. `picture` must have been drawn with the same rays.
vec4 at_pixel(sampler2D picture) { return texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
#else
in vec2 position;

void begin_place() {}

// The lookup interpolates, because the picture may have a different size.
vec4 at_pixel(sampler2D picture) { return texture(picture, 0.5 * position + 0.5); }
#endif
