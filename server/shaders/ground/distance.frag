// Distance of the ground along each pixel's ray; very large where the ray meets none. Variant: RELIEF.
#include "common/view.glsl"
#include "common/ground.glsl"

in vec2 position;
out float distance_m;

void main() {
  float ground_m = ground_distance_m(ray_origin(position), ray_direction(position));
  distance_m = ground_m > 0.0 ? ground_m : 1e30;
}
