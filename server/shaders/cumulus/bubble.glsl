// The ellipsoids of a cumulus surface, and where a ray meets one. Metres from the middle of the surface's box.
#include "cumulus/bindings.glsl"

struct Bubble {
  vec4 unit_x;   // rows of the matrix to where the bubble is the unit ball; w of this: radius of the ball of its volume
  vec4 unit_y;   // w: the longest semi-axis
  vec4 unit_z;
  vec4 centre_m;
  vec4 outward;  // normal of what it lies on; w: the index of that, or -1
};

layout(std430, binding = kBubblesBinding) readonly buffer Bubbles { Bubble bubbles[]; };

// M v and its transpose, of a bubble's matrix.
vec3 to_unit(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return vec3(dot(unit_x, v), dot(unit_y, v), dot(unit_z, v)); }
vec3 from_unit_normal(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return v.x * unit_x + v.y * unit_y + v.z * unit_z; }
