// Computes how the storm appears in the sky of each point of a coarse lattice around it, in the format of
// common/sky_hidden.glsl. The values are means over directions spread uniformly over the upper hemisphere. The first
// value is the storm's opacity. The second value is the opacity times a transmittance for diffuse light, which is that
// of a level layer of the same vertical depth.
//
// The transmittance of the layer is the two-stream solution (1 - a / r) exp(-sqrt(3 a r)) / (1 +
// 3/4 r). Here r is the similarity-scaled depth of transport, and a is the depth of absorption. The
// layer's reflectance is 1 minus its transmittance without absorption, times the reflectance of a
// semi-infinite layer. The latter is (1 - s) / (1 + s) with s = sqrt(a / r). The reflectance's mean
// over directions is stored as a vector. Variants: GROUPS, DETAILS (always 0, because fine detail
// averages out).
#include "common/bindings.glsl"
#include "common/medium.glsl"
#include "common/bricks.glsl"

layout(local_size_x = kLightGroupSide, local_size_y = kLightGroupSide) in;
layout(binding = kSkyHiddenImage, rg16f) uniform writeonly image3D hidden;
layout(binding = kStormFacesImage, rgba16f) uniform writeonly image3D faces;

uniform ivec3 point_count;
uniform vec3 lattice_low_m;  // low corner of the lattice's box, relative to the medium's middle
uniform vec3 lattice_size_m;
uniform float step_m;
uniform vec4 light_weights[PLANES];
uniform vec4 transport_weights[PLANES];
uniform vec4 absorption_weights[PLANES];

const int kDirections = 16;
const int kMaxSamples = 512;
const float kGoldenAngle = 2.39996323;

// Factors from a texel to the optical depths per step of the light's extinction, of transport and of absorption.
struct Depths {
  vec4 light[PLANES];
  vec4 transport[PLANES];
  vec4 absorption[PLANES];
};

vec3 depths_along(vec3 origin_m, vec3 direction, Depths of_step) {
  MediumRay ray = medium_ray(origin_m, direction);
  vec2 path = path_in_medium(origin_m, direction, 0.0);
  float distance_m = max(path.x, 0.0);
  vec3 depths = vec3(0.0);
  for (int i = 0; i < kMaxSamples && distance_m < path.y; ++i) {
    vec3 place = brick_place(ray, distance_m);
    uint content = brick_content(ray, place);
    if (!is_filled(content)) {
      distance_m += empty_path(ray, place, content);
      continue;
    }
    Medium medium = medium_at_place(medium_place(ray, distance_m + 0.5 * step_m), 0.0);
    depths += vec3(weigh(medium, of_step.light), weigh(medium, of_step.transport), weigh(medium, of_step.absorption));
    distance_m += step_m;
  }
  return depths;
}

void main() {
  begin_medium();
  ivec3 point = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(point, point_count))) return;
  vec3 origin_m = lattice_low_m + (vec3(point) + 0.5) / vec3(point_count) * lattice_size_m;
  Depths of_step = Depths(scaled(light_weights, step_m), scaled(transport_weights, step_m),
                          scaled(absorption_weights, step_m));
  vec2 sum = vec2(0.0);
  vec4 sum_of_faces = vec4(0.0);
  for (int i = 0; i < kDirections; ++i) {
    // The directions follow a Fibonacci spiral. The spiral is rotated differently at each point, so that all points
    // together cover all directions.
    float sine = 1.0 - (float(i) + 0.5) / float(kDirections);
    float azimuth = kGoldenAngle * (float(i) + float(point.x) + 3.0 * float(point.y) + 7.0 * float(point.z));
    float cosine = sqrt(1.0 - sine * sine);
    vec3 direction = safe_direction(vec3(cosine * cos(azimuth), cosine * sin(azimuth), sine));
    vec3 depths = depths_along(origin_m, direction, of_step);
    float opacity = 1.0 - exp(-depths.x);
    float scattered = 1.0 - depths.z / max(depths.y, 1e-9);
    float unabsorbed = 1.0 / (1.0 + 0.75 * depths.y * sine);
    float diffuse = scattered * exp(-sqrt(3.0 * depths.y * depths.z) * sine) * unabsorbed;
    float s = sqrt(clamp(1.0 - scattered, 0.0, 1.0));
    float reflected = opacity * (1.0 - unabsorbed) * (1.0 - s) / (1.0 + s);
    sum += opacity * vec2(1.0, diffuse);
    sum_of_faces += reflected * vec4(direction, 1.0);
  }
  // The outermost points of the lattice are beyond the region in which air is shaded, so they are set to zero.
  bvec3 first = equal(point, ivec3(0));
  bvec3 last = equal(point, point_count - 1);
  bool rim = first.x || first.y || last.x || last.y || last.z;
  float share = rim ? 0.0 : 1.0 / float(kDirections);
  imageStore(hidden, point, vec4(share * sum, 0.0, 0.0));
  imageStore(faces, point, share * sum_of_faces);
}
