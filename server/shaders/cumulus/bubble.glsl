// The ellipsoids of a cumulus surface, and the intersection of a ray with one. Coordinates are metres from the middle
// of the surface's box.
#include "cumulus/bindings.glsl"

struct Bubble {
  // unit_*: rows of the matrix that maps the bubble to the unit ball; w here: radius of a ball of equal volume
  vec4 unit_x;
  vec4 unit_y;   // w: the longest semi-axis
  vec4 unit_z;
  vec4 centre_m;
  vec4 outward;  // normal of the surface it lies on; w: index of the bubble it lies on, or -1
};

layout(std430, binding = kBubblesBinding) readonly buffer Bubbles { Bubble bubbles[]; };

// Multiply a vector by a bubble's matrix M, or by its transpose.
vec3 to_unit(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return vec3(dot(unit_x, v), dot(unit_y, v), dot(unit_z, v)); }
vec3 from_unit_normal(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return v.x * unit_x + v.y * unit_y + v.z * unit_z; }
