// Light scattered many times along a view ray, from the diffusion equation
// (renderers/light_volume/diffuse_light.h). The equation replaces the medium by one that scatters
// isotropically and has less extinction (similarity scaling). The diffuse light and the background
// are therefore attenuated by the similarity-scaled extinction. Extinctions are per step. This file
// needs common/medium.glsl, common/phase.glsl and light_volume/segment.glsl. Variant: TINTED (the
// diffuse light is absorbed or coloured).
#include "light_volume/bindings.glsl"
#include "physics/light_transport.glsl"

// Texels hold the square root of the optical depth to the nearest surface, DiffuseLight::SkySeen (x and y), and
// component x of DiffuseLight::SkyInward.
layout(binding = kExitsUnit) uniform sampler3D exits;
// Texels hold the net inward flux of sunlight, the fluence from other cloud walls (light_volume/wall_light.h), and
// component y of DiffuseLight::SkyInward. The last channel is the share of open ground's light that arrives from below.
layout(binding = kNetInwardUnit) uniform sampler3D net_inward;

uniform vec4 transport_weights[PLANES];  // factors from a texel to the similarity-scaled extinction in 1/m
uniform vec3 rest_of_sky;  // mean radiance of the sky without the bright region around the sun
uniform vec3 rest_of_sky_level;  // irradiance of that sky on level ground divided by pi
uniform vec3 around_sun;  // irradiance of the bright region around the sun, from the sun's direction
uniform vec3 from_ground;                // radiance of open ground
#if TINTED
uniform vec4 red_weights[PLANES];  // factors from a texel to the similarity-scaled scattering in 1/m
uniform vec4 green_weights[PLANES];
uniform vec4 blue_weights[PLANES];
#endif

vec4 transport_depths[PLANES];
#if TINTED
vec4 red_depths[PLANES];
vec4 green_depths[PLANES];
vec4 blue_depths[PLANES];
#endif

// Prepares the factors for the given step. Call it before the other functions.
void begin_diffuse(float step_m) {
  transport_depths = scaled(transport_weights, step_m);
#if TINTED
  red_depths = scaled(red_weights, step_m);
  green_depths = scaled(green_weights, step_m);
  blue_depths = scaled(blue_weights, step_m);
#endif
}

struct DiffuseSample {
  float transport;  // similarity-scaled extinction
  vec4 exits;
  vec4 inward;
  vec3 tint;  // scattering of red, green and blue
};

DiffuseSample diffuse_at(vec3 place, Medium medium) {
  vec3 tint = vec3(0.0);
#if TINTED
  tint = vec3(weigh(medium, red_depths), weigh(medium, green_depths), weigh(medium, blue_depths));
#endif
  return DiffuseSample(weigh(medium, transport_depths), texture(exits, place), texture(net_inward, place), tint);
}

DiffuseSample no_diffuse_sample() { return DiffuseSample(0.0, vec4(0.0), vec4(0.0), vec3(0.0)); }

DiffuseSample mixed(DiffuseSample a, DiffuseSample b, float at) {
  return DiffuseSample(mix(a.transport, b.transport, at), mix(a.exits, b.exits, at), mix(a.inward, b.inward, at),
                       mix(a.tint, b.tint, at));
}

// Sums over the ray's segments. Each segment is weighted by its visible share.
struct DiffuseSeen {
  float transmittance;  // transmittance for diffuse light and the background
  vec3 sun;  // fluence of sunlight divided by the sun's irradiance
  vec3 sky;  // weight of the sky's mean radiance
  vec3 level;  // weight of the sky's irradiance on level ground divided by pi
  vec3 ground;  // weight of open ground's radiance
};

DiffuseSeen no_diffuse_seen() { return DiffuseSeen(1.0, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)); }

// Returns the fluence of sunlight at the optical depth `sun_depth` from the sun. `scale` is the ratio of the
// similarity-scaled extinction to the extinction for the eye.
float sun_fluence(DiffuseSample there, float sun_depth, float scale) {
  float exit_depth = there.exits.x * there.exits.x;
  return diffuse_fluence(exit_depth, sun_depth, scale * exit_depth, there.inward.x, there.inward.y) +
         forward_fluence(exit_depth, sun_depth, scale * sun_depth);
}

// Returns the visible shares of the sky's irradiance from above (x) and of its mean radiance (y).
vec2 sky_shares_of(DiffuseSample there, float scale) {
  float exit_depth = there.exits.x * there.exits.x;
  vec2 shares = there.exits.yz - vec2(there.exits.w, there.inward.z) * (3.0 * scale * exit_depth + 2.0);
  return shares * (clamp(shares.x + shares.y, 0.0, 1.0) / max(shares.x + shares.y, 1e-6));
}

// Adds a segment. The share of the diffuse light that the segment removes is `taken.share`. The
// square root of the optical depth from the sun is `sun_depth_root`. The extinction for the eye is
// `extinction`. These two and `there` are values at the place where half of `taken.share` is
// reached. Returns the segment's weight in the pixel.
float see_diffuse(inout DiffuseSeen seen, Taken taken, DiffuseSample there, float sun_depth_root, float extinction) {
  float scale = there.transport / max(extinction, 1e-30);
  float fluence = sun_fluence(there, sun_depth_root * sun_depth_root, scale);
  vec2 sky_shares = sky_shares_of(there, scale);
  float shown = seen.transmittance * taken.share;
#if TINTED
  vec3 tint = there.tint / max(there.transport, 1e-30);
#else
  const vec3 tint = vec3(1.0);
#endif
  seen.sun += (shown * fluence) * tint;
  seen.level += (shown * sky_shares.x) * tint;
  seen.sky += (shown * sky_shares.y) * tint;
  seen.ground += (shown * (1.0 - sky_shares.x - sky_shares.y) * there.inward.w) * tint;
  seen.transmittance *= 1.0 - taken.share;
  return shown;
}

// Completes the sums of a ray that was stopped inside the medium. Deep in a cloud, diffuse light varies little. The mean over the
// visible part is therefore extrapolated to the rest.
void close_diffuse(inout DiffuseSeen seen) {
  float whole = 1.0 / (1.0 - seen.transmittance);
  seen.sun *= whole;
  seen.sky *= whole;
  seen.level *= whole;
  seen.ground *= whole;
  seen.transmittance = 0.0;
}

vec3 diffuse_radiance(DiffuseSeen seen, vec3 sunlight) {
  return (sunlight + around_sun) * seen.sun / kFourPi + rest_of_sky * seen.sky + rest_of_sky_level * seen.level +
         from_ground * seen.ground;
}
