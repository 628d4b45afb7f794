// What one slice sends to the eye: radiance scattered there (rgb) and the share of what lies behind that passes (a).
// Riley et al. 2003 (Vis), eq. 5 with the phase of eq. 18; the light comes from the light buffer.
// Variants: GROUND (what lies behind it is left out), GROUPS, COLORED (per-group colours), TRANSLUCENT, CONSISTENT (transport), FRONT_TO_BACK (the eye is on the
// sun's side).
#include "common/medium.glsl"
#include "common/phase.glsl"
#include "physics/light_transport.glsl"

layout(binding = 4) uniform sampler2D light;      // r: share of sunlight, g: optical depth towards the sun
layout(binding = 5) uniform sampler2D thickness;  // r: optical depth along the whole sun ray

#if GROUND
layout(binding = 7) uniform sampler2D ground_distance;
uniform vec3 eye_middle_m;
#endif
uniform vec4 eye_local_m;            // with w = 0 a direction: infinitely far
uniform vec3 towards_sun;
uniform vec3 slice_normal;
uniform float spacing_m;
uniform float light_path_m;          // length of a sun ray between two slices
uniform vec4 eye_weights[PLANES];        // texel to the extinction that the eye sees, 1/m
uniform vec4 light_weights[PLANES];      // texel to the extinction that the light buffer sees, 1/m
uniform vec4 scattering_weights[PLANES];  // texel to scattering, 1/m
uniform vec4 transport_weights[PLANES];  // texel to similarity-scaled extinction, 1/m
uniform vec3 sunlight;               // irradiance
uniform vec3 ambient;                // mean radiance from sky and ground
uniform vec3 light_u;                // light buffer axes, scaled to its texture coordinates
uniform vec3 light_v;

in vec3 local_m;
out vec4 radiance_and_transmittance;

void main() {
  begin_medium();
  Medium medium = medium_at(local_m);
  float extinction = weigh(medium, eye_weights);

  vec3 ray = normalize(local_m * eye_local_m.w - eye_local_m.xyz);
#if GROUND
  if (dot(local_m - eye_middle_m, ray) > texelFetch(ground_distance, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  // A ray along the slices would have no end; the limit is where perspective's corners lie in the widest view.
  float path_m = spacing_m / max(abs(dot(ray, slice_normal)), 0.05);
  float depth = extinction * path_m;
  float mu = dot(ray, towards_sun);
  vec2 light_place = vec2(dot(local_m, light_u), dot(local_m, light_v)) + 0.5;
  vec2 arrived = texture(light, light_place).rg;

  vec3 direct = vec3(0.0);
  for (int group = 0; group < GROUPS; ++group) {
    float value = medium.plane[group / 4][group % 4] * scattering_weights[group / 4][group % 4];
    direct += value * phase_term(group, mu);
  }
  vec3 source = direct * arrived.r * sunlight;

  float seen = mean_transmittance(depth);
#if CONSISTENT
  // The buffer holds the light that enters the slice; on its way through, light fades as the view does.
  float light_depth = weigh(medium, light_weights) * light_path_m;
  source *= FRONT_TO_BACK == 1 ? mean_transmittance(depth + light_depth)
                               : mean_counter_transmittance(depth, light_depth);
  vec3 isotropic = ambient;
#if TRANSLUCENT
  float total = texture(thickness, light_place).r;
  float slice_depth = weigh(medium, transport_weights) * light_path_m;
  // Diffuse light that leaves a cloud comes from one transport mean free path (2/3 by Eddington) inside it.
  float within = FRONT_TO_BACK == 1 ? mean_seen_place(depth) : 1.0 - mean_seen_place(depth);
  float tau = min(arrived.g + within * slice_depth + 2.0 / 3.0, total);
  isotropic += sunlight * diffuse_mean_intensity(tau, total);
#endif
  float scattering = weigh(medium, scattering_weights);
  vec3 tint = vec3(1.0);
#if COLORED
  tint = vec3(0.0);
  for (int group = 0; group < GROUPS; ++group) {
    tint += group_color[group] * (medium.plane[group / 4][group % 4] * scattering_weights[group / 4][group % 4]);
  }
  tint /= max(scattering, 1e-30);
#endif
  float albedo = scattering / max(total_extinction(medium), 1e-30);
  source += tint * isotropic * (extinction * albedo * seen);
#else
  source *= seen;
#endif

  radiance_and_transmittance = vec4(source * path_m, exp(-depth));
}
