// The place of a pixel's ray in the picture, `position`, from (-1, -1), left and bottom, to (1, 1). Call begin_place
// first. Variant: CHOSEN (the rays of renderers::ChosenRays instead of the picture's).
#include "common/bindings.glsl"

#if CHOSEN
layout(binding = kChosenPlacesUnit) uniform sampler2D chosen_places;

vec2 position;

void begin_place() { position = texelFetch(chosen_places, ivec2(gl_FragCoord.xy), 0).rg; }

// Returns the texel of a picture of the same rays.
vec4 at_pixel(sampler2D picture) { return texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
#else
in vec2 position;

void begin_place() {}

// The lookup interpolates, because the picture may have another size.
vec4 at_pixel(sampler2D picture) { return texture(picture, 0.5 * position + 0.5); }
#endif
