// Writes the distance of the ground along each pixel's ray. If the ray does not meet the ground, it writes a very large
// value. Variants: RELIEF, CHOSEN.
#include "common/ray_place.glsl"
#include "common/view.glsl"
#include "common/ground.glsl"

out float distance_m;

void main() {
  begin_place();
  float ground_m = ground_distance_m(ray_origin(position), ray_direction(position));
  distance_m = ground_m > 0.0 ? ground_m : 1e30;
}
