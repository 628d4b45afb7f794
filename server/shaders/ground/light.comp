// Computes the light that reaches level ground, relative to the light of open ground (r), and the ground's height above
// sea level (g). The values are at the points of a lattice in world coordinates. Variant: RELIEF.
#include "common/bindings.glsl"
#include "common/ground.glsl"
#include "common/sky_hidden.glsl"
#include "common/storm_shadow.glsl"

const float kMaxShare = 2.0;

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kGroundLightImage, rg32f) uniform writeonly image3D light;

uniform ivec3 point_count;
uniform vec3 lattice_low_m;
uniform vec3 lattice_size_m;
uniform vec3 towards_sun;
uniform float sunlit_share;  // share of direct sunlight in the light of open ground
uniform float mean_albedo;  // mean albedo of the ground

void main() {
  ivec3 point = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(point, point_count))) return;
  vec3 place_m = lattice_low_m + (vec3(point) + 0.5) / vec3(point_count) * lattice_size_m;
#if RELIEF
  place_m.z = terrain_m(place_m.xy);
#else
  place_m.z = lowest_ground_m;
#endif
  float blocked = blocked_behind(place_m);
  StormInSky storm = storm_in_sky(place_m);
  float reflected = light_of_faces_on_ground(storm, towards_sun, vec3(1.0 - sunlit_share)).r;
  // The ground is lit as in post/composite.frag. Multiple reflections between ground and storm are added.
  float share = sunlit_share * (1.0 - blocked) + (1.0 - sunlit_share) * (1.0 - storm.hidden) + mix(reflected, storm.through, blocked);
  share /= 1.0 - mean_albedo * clamp(storm.reflects, 0.0, 1.0);
  imageStore(light, point, vec4(min(share, kMaxShare), place_m.z, 0.0, 0.0));
}
