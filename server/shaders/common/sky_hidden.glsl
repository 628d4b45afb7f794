// Looks up how the storm appears in the sky of a point (air/sky_hidden.comp).
#include "common/bindings.glsl"

layout(binding = kSkyHiddenUnit) uniform sampler3D sky_hidden;
layout(binding = kStormFacesUnit) uniform sampler3D storm_faces;

uniform vec3 hidden_scale;  // texture coordinates per metre
uniform vec3 hidden_offset;
uniform vec3 faces_sunlight;  // irradiance of the sun on those parts of the storm's surface that face the sun

struct StormInSky {
  float hidden;  // share of the sky that the storm hides
  // Mean radiance of the storm to a point in its shadow, times pi, divided by the irradiance on
  // level ground by the sun and the clear sky.
  float through;
  float reflects;  // share of light from outside that the storm reflects
  vec3 faces;  // mean of the reflected share times the direction in which it is seen
};

StormInSky storm_in_sky(vec3 point_m) {
  vec3 place = point_m * hidden_scale + hidden_offset;
  vec2 shares = texture(sky_hidden, place).rg;
  vec4 reflected = texture(storm_faces, place);
  return StormInSky(shares.x, shares.y, reflected.a, reflected.rgb);
}

// Returns the mean radiance over the sky, times pi, of the light that the storm's faces reflect to
// a point outside the storm's shadow. Faces count as oriented like those of a white sphere. Let a
// be the angle at the sphere between the sun and the point. The sphere has the share (sin a + (pi -
// a) cos a) / pi of its full brightness, which the function approximates by 3/8 + cos(a) / 2. The
// full brightness is 2/3 of that of a flat face. `skylight` is the irradiance on level ground, of
// which the faces get half.
vec3 light_of_faces(StormInSky storm, vec3 towards_sun, vec3 skylight) {
  float sunlit = max(storm.reflects / 4.0 - dot(storm.faces, towards_sun) / 3.0, 0.0);
  return sunlit * faces_sunlight + 0.5 * storm.reflects * skylight;
}

// Returns the irradiance on level ground of the light that the storm's faces reflect. Each direction contributes in
// proportion to the sine of its elevation, whose mean over the sky is 1/2.
vec3 light_of_faces_on_ground(StormInSky storm, vec3 towards_sun, vec3 skylight) {
  float raised = 2.0 * storm.faces.z / max(storm.reflects, 1e-6);
  return raised * light_of_faces(storm, towards_sun, skylight);
}
