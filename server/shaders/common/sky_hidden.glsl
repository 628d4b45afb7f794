// The storm in a point's sky (air/sky_hidden.comp).
#include "common/bindings.glsl"

layout(binding = kSkyHiddenUnit) uniform sampler3D sky_hidden;
layout(binding = kStormFacesUnit) uniform sampler3D storm_faces;

uniform vec3 hidden_scale;  // texture coordinates per metre
uniform vec3 hidden_offset;
uniform vec3 faces_sunlight;  // irradiance of the sun on faces of the storm that are turned to it

struct StormInSky {
  float hidden;   // the share of the sky that the storm hides
  float through;  // the mean radiance that it sends in place of it to a point in its shadow, times pi, for an irradiance of 1 on
                  // level ground under the clear sky
  float reflects; // the share that it reflects of light from outside
  vec3 faces;     // of that share times the direction where it is seen: its mean
};

StormInSky storm_in_sky(vec3 point_m) {
  vec3 place = point_m * hidden_scale + hidden_offset;
  vec2 shares = texture(sky_hidden, place).rg;
  vec4 reflected = texture(storm_faces, place);
  return StormInSky(shares.x, shares.y, reflected.a, reflected.rgb);
}

// The mean radiance over the sky, times pi, of what the storm's faces reflect to a point that is not in its shadow. Faces are
// turned as those of a white sphere, which has (sin a + (pi - a) cos a) / pi of its full brightness, 2/3 of a flat face's, at
// the angle a from the sun: here 3/8 + cos(a) / 2. `skylight` is the irradiance on level ground, half of which they get.
vec3 light_of_faces(StormInSky storm, vec3 towards_sun, vec3 skylight) {
  float sunlit = max(storm.reflects / 4.0 - dot(storm.faces, towards_sun) / 3.0, 0.0);
  return sunlit * faces_sunlight + 0.5 * storm.reflects * skylight;
}

// The irradiance of that on level ground, which gets of each direction the sine of its elevation, 1/2 in the mean over the sky.
vec3 light_of_faces_on_ground(StormInSky storm, vec3 towards_sun, vec3 skylight) {
  float raised = 2.0 * storm.faces.z / max(storm.reflects, 1e-6);
  return raised * light_of_faces(storm, towards_sun, skylight);
}
