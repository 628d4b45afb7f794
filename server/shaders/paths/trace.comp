// Traces random paths through the medium, with one invocation for each path. It performs the same events as the
// estimator of reference/path_radiance.h. In a pass, each path is traced for a few events and then stored. The paths
// that continue are listed for the next pass, so that no pass waits long for the longest path. The host computes the
// air, the ground and the sky that an eye sees (reference/eye_segment.h), and the sky into which a path leaves.
#include "paths/scattering.glsl"

layout(local_size_x = kPathGroupSize) in;

struct PathState {
  vec4 place;  // xyz: place in bricks; w: limit of the path's first flight in metres
  vec4 direction;  // xyz: unit vector; w: one of the constants kPath...
  vec4 throughput;  // w: number of collisions so far
  // Weights by colour. They compensate for sampling only the phase functions of one colour, the
  // path's hero colour. w: number of collisions at which the path next continues by roulette.
  vec4 spectral;
  vec4 radiance;  // w: also the result, if it is a distance or a transmittance
  uvec4 counter;  // counter of the path's random numbers; x is the index of the next block
};
layout(std430, binding = kPathStatesBinding) buffer States { PathState states[]; };
layout(std430, binding = kPathListBinding) readonly buffer List {
  uint list_count;
  uint listed[];
};
layout(std430, binding = kPathNextListBinding) buffer NextList {
  uint next_count;
  uint next_listed[];
};
// The sun's irradiance at steps of height. The direction and the irradiance of each other light follow.
layout(std430, binding = kPathLightsBinding) readonly buffer Lights { vec4 lights[]; };

uniform int first_path;  // first path of this dispatch
uniform int end_path;
uniform bool by_list;  // true if paths are indices into the list
uniform ivec2 key;
uniform vec3 towards_sun;
uniform int sun_heights;
uniform float sun_step_m;
uniform int other_lights;
uniform int similar_after;  // number of collisions after which the path continues in the similar medium; 0 means never
uniform vec3 brick_m;
uniform float low_height_m;  // height of the first brick above sea level
uniform bool has_ground;
uniform vec3 low_from_touch_m;  // vector from the point where the ground touches its plane to the first brick
uniform vec3 ground_albedo;
uniform vec3 ground_radiance;
uniform float ground_curvature_per_m;

PathState path;
int collisions;
int hero;

float largest(vec3 color) { return max(color.x, max(color.y, color.z)); }

bool is_similar() { return similar_after > 0 && collisions >= similar_after; }

vec3 carried() { return path.throughput.xyz * path.spectral.xyz; }

bool survives() {
  float most = largest(carried());
  if (most >= kRouletteThroughput) return true;
  if (random_uniform() * kRouletteThroughput >= most) return false;
  path.throughput.xyz *= kRouletteThroughput / most;
  return true;
}

bool goes_on_at_length() {
  ++collisions;
  if (float(collisions) < path.spectral.w) return true;
  path.spectral.w *= 4.0;
  path.throughput.xyz *= 2.0;
  return random_uniform() < 0.5;
}

vec3 sunlight_at(vec3 place) {
  float height_m = low_height_m + place.z * brick_m.z;
  float step = clamp(height_m / sun_step_m, 0.0, float(sun_heights - 1));
  int below = clamp(int(step), 0, max(sun_heights - 2, 0));
  return mix(lights[below].xyz, lights[min(below + 1, sun_heights - 1)].xyz, step - float(below));
}

// Returns the distance to the ground, computed as in reference/eye_segment.h.
float ground_distance_m() {
  if (!has_ground) return kEndlessPath_m;
  vec3 off_m = low_from_touch_m + path.place.xyz * brick_m;
  vec2 across = path.direction.xy;
  float above_m = off_m.z + 0.5 * ground_curvature_per_m * dot(off_m.xy, off_m.xy);
  float closing = -path.direction.z - ground_curvature_per_m * dot(off_m.xy, across);
  float discriminant = closing * closing - 2.0 * ground_curvature_per_m * dot(across, across) * above_m;
  if (above_m <= 0.0 || closing <= 0.0 || discriminant < 0.0) return kEndlessPath_m;
  return 2.0 * above_m / (closing + sqrt(discriminant));
}

// Moves the path vertically onto the ground.
void put_on_ground() {
  vec2 off_m = low_from_touch_m.xy + path.place.xy * brick_m.xy;
  path.place.z = -(low_from_touch_m.z + 0.5 * ground_curvature_per_m * dot(off_m, off_m)) / brick_m.z;
}

// Values for the place of a path after its flight.
const int kAtEnd = 0;
const int kAtParticle = 1;
const int kAtGround = 2;

int fly(inout int what) {
  float ground_m = what == kPathMeets ? path.place.w : what == kPathTries ? kEndlessPath_m : ground_distance_m();
  float at_m = distance_to_collision(path.place.xyz, path.direction.xyz, ground_m, is_similar());
  if (what == kPathMeets) {
    path.radiance.w = at_m;
    what = kPathEnded;
    return kAtEnd;
  }
  bool meets = at_m >= 0.0;
  if (!meets && (what == kPathTries || ground_m >= kEndlessPath_m)) {
    what = what == kPathTries ? kPathMissed : kPathEscaped;
    return kAtEnd;
  }
  path.place.xyz += (meets ? at_m : ground_m) * path.direction.xyz * bricks_per_m;
  what = kPathFlies;
  if (meets) return kAtParticle;
  put_on_ground();
  return kAtGround;
}

// Performs one event of the path. Returns false when the path has ended.
bool advances(inout int what) {
  if (what == kPathFlies && !survives()) {
    what = kPathEnded;
    return false;
  }
  int at = what == kPathScatters ? kAtParticle : kAtEnd;
  if (what != kPathScatters && what != kPathShines) {
    at = fly(what);
    if (at == kAtEnd) return false;
  }
  if (what == kPathScatters) what = kPathFlies;
  GroupOptics optics;
  bool ends = false;
  if (at == kAtParticle) {
    float factor;
    bool similar_before = is_similar();
    int group = choose_group(path.place.xyz, random_uniform(), similar_before, factor);
    ends = group < 0;
    if (!ends) {
      // This collision was found with the optics that applied before it. After the collision is counted, all light may
      // count as light of the similar medium, including the sunlight of this collision.
      optics = group_optics[2 * group + int(similar_before)];
      path.throughput.xyz *= factor * optics.albedo.xyz;
      ends = !survives() || !goes_on_at_length();
    }
  } else if (at == kAtGround) {
    path.radiance.xyz += carried() * ground_radiance;
    path.throughput.xyz *= ground_albedo;
    ends = largest(carried()) <= 0.0;
  }
  if (ends) {
    what = kPathEnded;
    return false;
  }

  // Adds the light that arrives directly from the sun and the other lights.
  int count = at == kAtParticle ? 1 + other_lights : 1;
  for (int i = 0; i < count; ++i) {
    int other = sun_heights + 2 * (i - 1);
    vec3 towards = what == kPathShines ? path.direction.xyz : i == 0 ? towards_sun : lights[other].xyz;
    vec3 irradiance = what == kPathShines ? vec3(1.0) : i == 0 ? sunlight_at(path.place.xyz) : lights[other + 1].xyz;
    vec3 reflected = vec3(1.0);
    if (at == kAtParticle) {
      vec3 apart = path.direction.xyz - towards;
      vec3 value = phase_value(optics, 0.5 * dot(apart, apart));
      float worth = min(largest(carried() * value) / kRouletteSunlight, 1.0);
      reflected = random_uniform() < worth ? value / (4.0 * kPi * worth) : vec3(0.0);
    } else if (at == kAtGround) {
      reflected = vec3(max(towards_sun.z, 0.0) / kPi);
    }
    vec3 unshadowed = carried() * reflected * irradiance;
    if (largest(unshadowed) <= 0.0) continue;
    float transmittance = transmittance_to_infinity(path.place.xyz, towards, is_similar());
    path.radiance += vec4(unshadowed * transmittance, transmittance);
  }
  if (what == kPathShines) {
    what = kPathEnded;
    return false;
  }

  if (at == kAtParticle) {
    vec3 weight;
    float x = sample_phase(optics, random_uniform(), hero, weight);
    // Weights by colour: Wilkie et al. 2014, eq. 8.
    path.spectral.xyz *= weight;
    path.spectral.xyz *= 3.0 / (path.spectral.x + path.spectral.y + path.spectral.z);
    path.direction.xyz = deflected(path.direction.xyz, x, 2.0 * kPi * random_uniform());
  } else {
    float sine = sqrt(random_uniform());  // sine of the elevation
    float azimuth = 2.0 * kPi * random_uniform();
    path.direction.xyz = vec3(sqrt(max(1.0 - sine * sine, 0.0)) * vec2(cos(azimuth), sin(azimuth)), sine);
  }
  return true;
}

void main() {
  int slot = first_path + int(gl_GlobalInvocationID.x);
  if (slot >= end_path) return;
  uint index = by_list ? listed[slot] : uint(slot);
  path = states[index];
  random_key = uvec2(key);
  random_counter = path.counter;
  hero = int(path.counter.y >> 30);
  collisions = int(path.throughput.w);
  int what = int(path.direction.w);
  bool goes = true;
  for (int i = 0; i < kPathEvents && goes; ++i) goes = advances(what);
  path.direction.w = float(what);
  path.throughput.w = float(collisions);
  path.counter.x = random_counter.x;
  states[index] = path;
  if (goes) next_listed[atomicAdd(next_count, 1u)] = index;
}
