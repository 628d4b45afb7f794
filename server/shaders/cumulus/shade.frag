// Neyret's shading of a cumulus (2000, section 4): Lambert's law on a rough surface, light traps between bubbles, the
// light map of sky and ground, and a corona that scatters forwards. The corona is a translucent rim around the opaque
// core of a bubble. Core and corona are mixed by the density rho at the ray's deepest point, which grows from 0 to 1
// through the corona. If two bubbles are closer to each other than the corona's thickness, their cores are mixed too.
// The output is the weighted sum of the cores close to the nearest one, and a layer of everything in front of them.
// Variants: PLAIN (only Lambert's law), and those of cumulus/meeting.glsl.
#include "common/sunlight.glsl"
#include "cumulus/bindings.glsl"
#include "cumulus/meeting.glsl"

layout(binding = kCoreDepthUnit) uniform sampler2D core_depth;  // from depth.frag
layout(binding = kSunDepthUnit) uniform sampler2D shadow_depth;  // from depth.frag, as seen from the sun
layout(binding = kRoughnessNoiseUnit) uniform sampler3D roughness_noise;

uniform float corona_m;  // thickness of the corona, dR of the paper
uniform float per_far;
uniform vec3 towards_sun;
// Harmonics of the radiance of a white surface in the light of sky and ground, as a function of its normal.
uniform vec3 light_map[9];
uniform vec4 component;  // weights of direct light, inter-reflection, ambient light and corona
uniform float trap_share;  // share of the sky that the deepest valley at one scale hides
uniform float transmission;  // share of sunlight that passes through the cloud
uniform float roughness;
uniform float noise_wave_m;   // wavelength of the noise's first octave
uniform float noise_per_m;  // number of noise tiles in a metre
uniform vec3 noise_offset;
uniform float pixel_share;  // size of a pixel divided by its distance; for parallel rays, the size in metres
uniform bool parallel;
uniform vec4 shadow_x;  // rows of the transformation from a point to the shadow's texture coordinates and depth
uniform vec4 shadow_y;
uniform vec4 shadow_z;
uniform float shadow_texel_m;

layout(location = 0) out vec4 cores;  // radiance times weight, weight
layout(location = 1) out vec4 layer;  // radiance, transmittance

const float kPi = 3.14159265;
const float kTrapSharpness = 4.0;  // k of the paper
const int kTrapScales = 6;
const float kCoronaVariance = 0.16;  // variance of the scattering angle at the deepest corona: sigma_max 0.4 rad
const float kNarrowest = 400.0;  // exponent of the cosine in the forward lobe of a single droplet
const int kReliefScales = 3;
// Wavelengths of the roughness relative to the wavelength of the noise, and its heights relative to the wavelengths.
// Light scattered inside the cloud smooths out structure smaller than the distance that light travels there. The finest
// scale therefore has the smallest height.
const vec3 kReliefWave = vec3(4.0, 1.0, 0.25);
const vec3 kReliefHeight = vec3(0.35, 0.2, 0.06);

float noise_root(vec3 point_m) { return texture(roughness_noise, point_m * noise_per_m + noise_offset).r; }

// Returns the share of sunlight that passes other bubbles. It is interpolated between a texel of the shadow map and its
// neighbours.
float lit_texels(vec2 texel, float depth) {
  ivec2 size = textureSize(shadow_depth, 0);
  ivec2 low = ivec2(floor(texel));
  vec2 share = texel - floor(texel);
  vec4 open;
  for (int i = 0; i < 4; ++i) {
    ivec2 at = low + ivec2(i & 1, i >> 1);
    bool outside = any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size));
    open[i] = outside || texelFetch(shadow_depth, at, 0).r >= depth ? 1.0 : 0.0;
  }
  vec2 rows = mix(open.xz, open.yw, share.x);
  return mix(rows.x, rows.y, share.y);
}

// Returns the texel of the shadow map (xy) and the depth from the sun (z) of a point.
vec3 shadow_place(vec3 point_m) {
  vec4 p = vec4(point_m, 1.0);
  return vec3(vec2(dot(shadow_x, p), dot(shadow_y, p)) * vec2(textureSize(shadow_depth, 0)) - 0.5, dot(shadow_z, p));
}

// Returns the share of sunlight that reaches a point.
float lit(vec3 point_m) {
  vec3 place = shadow_place(point_m);
  return lit_texels(place.xy, place.z);
}

// Returns the share of sunlight that reaches a surface. It is the mean over places on the surface that are two corona
// thicknesses apart, because light spreads sideways inside the cloud and blurs shadows to that width. `cosine` is that
// of the sun's angle to the normal.
float lit_softly(vec3 point_m, vec3 normal, float cosine) {
  const float kMinCosine = 0.05;  // on steeper surfaces the places would be too far apart in depth
  vec3 place = shadow_place(point_m);
  vec2 tilt = vec2(dot(normalize(shadow_x.xyz), normal), dot(normalize(shadow_y.xyz), normal)) / max(cosine, kMinCosine);
  float per_m = length(shadow_z.xyz);
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 aside_m = corona_m * (2.0 * vec2(i & 1, i >> 1) - 1.0);
    sum += lit_texels(place.xy + aside_m / shadow_texel_m, place.z + per_m * dot(aside_m, tilt));
  }
  return 0.25 * sum;
}

vec3 from_surroundings(vec3 n) {
  vec3 sum = light_map[0] + light_map[1] * n.y + light_map[2] * n.z + light_map[3] * n.x + light_map[4] * (n.x * n.y) +
             light_map[5] * (n.y * n.z) + light_map[6] * (3.0 * n.z * n.z - 1.0) + light_map[7] * (n.x * n.z) +
             light_map[8] * (n.x * n.x - n.y * n.y);
  return max(sum, vec3(0.0));
}

// Returns the share (0 to 1) of noise of the wavelength `wave_m` that pixels of the size `pixel_m` resolve.
float resolved(float wave_m, float pixel_m) { return clamp(1.5 - 3.0 * pixel_m / wave_m, 0.0, 1.0); }

// Returns the normal of a surface that is rough at all scales. Roughness finer than pixels is omitted.
vec3 roughened(vec3 normal, vec3 point_m, float pixel_m) {
  if (roughness <= 0.0) return normal;
  vec3 right = normalize(cross(normal, abs(normal.z) < 0.7 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = cross(normal, right);
  vec3 rough = normal;
  for (int scale = 0; scale < kReliefScales; ++scale) {
    float wave_m = kReliefWave[scale] * noise_wave_m;
    float height = roughness * kReliefHeight[scale] * resolved(wave_m, pixel_m);
    if (height <= 0.0) break;
    float step_m = max(wave_m / 16.0, 0.5 * pixel_m);
    vec3 place = point_m / kReliefWave[scale];
    float step = step_m / kReliefWave[scale];
    float here = noise_root(place);
    vec2 rise = vec2(noise_root(place + step * right), noise_root(place + step * up)) - here;
    rough -= height * wave_m / step_m * (rise.x * right + rise.y * up);
  }
  return normalize(rough);
}

// Returns the light reflected between bubbles (section 4.3). At each scale, the valley around a bubble hides a share of
// the sky. The share follows from the height on the bubble by the paper's arc tangent. The hidden solid angle 2 pi -
// Omega sends (2 pi - Omega) / Omega times the mean light that arrives at the valley, by Lambert's law on the
// underlying surface.
//
// At a coarser scale, the light is multiplied by the share of the sky that the finer scales leave open. Any number of
// scales therefore sends at most 1 / (1 - trap_share) times the light. In uniformly bright surroundings, a valley is as
// bright as the rest, because light is neither lost nor gained.
vec3 trapped(vec3 point_m, vec3 sunlight, out float sky_share) {
  vec3 sum = vec3(0.0);
  sky_share = 1.0;
  int at = index;
  for (int scale = 0; scale < kTrapScales && at >= 0; ++scale) {
    Bubble bubble = bubbles[at];
    vec3 outward = bubble.outward.xyz;
    if (outward == vec3(0.0)) break;  // a single bubble has no valley
    float height = dot(outward, normalize(point_m - bubble.centre_m.xyz));
    float valley = trap_share * min(atan(kTrapSharpness * (1.0 - height)) / atan(kTrapSharpness), 1.0);
    int parent = int(bubble.outward.w);
    vec3 underlying = outward;
    if (parent >= 0) {
      Bubble below = bubbles[parent];
      vec3 unit = to_unit(below.unit_x.xyz, below.unit_y.xyz, below.unit_z.xyz, point_m - below.centre_m.xyz);
      underlying = normalize(from_unit_normal(below.unit_x.xyz, below.unit_y.xyz, below.unit_z.xyz, unit));
    }
    float received = max(dot(underlying, towards_sun), 0.0);
    if (valley > 0.0 && received > 0.0) {
      received *= lit(point_m + bubble.unit_x.w * underlying);
      sum += sunlight * (sky_share * received / kPi * valley / (1.0 - valley));
    }
    sum += sky_share * valley * from_surroundings(underlying);
    sky_share *= 1.0 - valley;
    at = parent;
  }
  return sum;
}

// Returns the radiance of the opaque core of a bubble.
vec3 core(Meeting meeting, vec3 point_m, float pixel_m) {
#if PLAIN
  return sunlight_at(point_m.z) * (max(dot(meeting.normal, towards_sun), 0.0) / kPi);
#else
  vec3 sunlight = sunlight_at(point_m.z);
  vec3 normal = roughened(meeting.normal, point_m, pixel_m);
  float cosine = max(dot(normal, towards_sun), 0.0);
  if (cosine > 0.0) {
    float straight = dot(meeting.normal, towards_sun);
    cosine *= lit_softly(point_m + (1.5 * shadow_texel_m + corona_m) * meeting.normal, meeting.normal, straight);
  }
  float sky_share;
  vec3 trap = trapped(point_m, sunlight, sky_share);
  vec3 ambient = sky_share * from_surroundings(normal) + sunlight * (transmission / kPi);
  return component.x * sunlight * (cosine / kPi) + component.y * trap + component.z * ambient;
#endif
}

// Returns the radiance of the corona (section 4.2, appendix A). It is 0 for rays away from the sun.
// The variance of the scattering angle grows with the number of droplets on the path. The lobe is a
// power of the cosine, scaled to conserve energy.
vec3 corona(Meeting meeting, float rho) {
  float mu = dot(meeting.ray, towards_sun);
  if (mu <= 0.0) return vec3(0.0);
  float most = 2.0 * sqrt(2.0 * unit_x.w * corona_m);
  float variance = kCoronaVariance * rho * (meeting.exit_m - meeting.entry_m) / most;
  float power = clamp(1.0 / max(variance, 1e-6), 1.0, kNarrowest);
  vec3 point_m = meeting.origin_m + meeting.exit_m * meeting.ray;
  float arriving = lit(point_m + (1.5 * shadow_texel_m + corona_m) * towards_sun);
  return sunlight_at(point_m.z) * (rho * arriving * (power + 1.0) / (2.0 * kPi) * pow(mu, power));
}

void main() {
  Meeting meeting;
  if (!meet(meeting)) discard;
  float core_m = texelFetch(core_depth, ivec2(gl_FragCoord.xy), 0).r / per_far;
#if PLAIN
  if (meeting.entry_m > core_m * (1.0 + 1e-5)) discard;
  cores = vec4(core(meeting, meeting.origin_m + meeting.entry_m * meeting.ray, 0.0), 1.0);
  layer = vec4(0.0, 0.0, 0.0, 1.0);
#else
  float behind_m = meeting.entry_m - core_m;
  if (behind_m > corona_m || meeting.depth_m <= 0.0) discard;
  vec3 point_m = meeting.origin_m + meeting.entry_m * meeting.ray;
  float pixel_m = parallel ? pixel_share : pixel_share * meeting.entry_m;
  float rho = min(meeting.depth_m / corona_m, 1.0);
  // The corona is thinner where the noise is low. Densities of 0 and 1 stay unchanged.
  if (rho < 1.0 && roughness > 0.0) {
    float fine = mix(0.7, noise_root(4.0 * point_m), resolved(0.25 * noise_wave_m, pixel_m));
    rho = pow(rho, exp(3.0 * roughness * (1.4 - noise_root(point_m) - fine)));
  }
  float together = max(1.0 - abs(behind_m) / corona_m, 0.0);
  together = rho < 1.0 ? together * together : max(together * together, 1e-3);
  vec3 radiance = core(meeting, point_m, pixel_m);
  cores = together * rho * vec4(radiance, 1.0);
  float apart = behind_m < 0.0 ? 1.0 - together : 0.0;
  vec3 scattered = component.w * (1.0 - rho) * corona(meeting, rho);
  layer = vec4(apart * (rho * radiance + scattered), 1.0 - apart * rho);
#endif
}
