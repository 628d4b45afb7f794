// The ellipsoids (bubbles) of a cumulus surface, and the intersection of a ray with a bubble. Coordinates are metres
// from the middle of the surface's box.
#include "cumulus/bindings.glsl"

struct Bubble {
  // unit_x, unit_y and unit_z are the rows of the matrix that maps the bubble to the unit ball. The w of unit_x is the
  // radius of a ball of equal volume.
  vec4 unit_x;
  vec4 unit_y;  // w: longest semi-axis
  vec4 unit_z;
  vec4 centre_m;
  vec4 outward;  // xyz: normal of the surface on which the bubble lies; w: index of the bubble on which it lies, or -1
};

layout(std430, binding = kBubblesBinding) readonly buffer Bubbles { Bubble bubbles[]; };

// Multiply a vector by a bubble's matrix, or by the transpose of the matrix.
vec3 to_unit(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return vec3(dot(unit_x, v), dot(unit_y, v), dot(unit_z, v)); }
vec3 from_unit_normal(vec3 unit_x, vec3 unit_y, vec3 unit_z, vec3 v) { return v.x * unit_x + v.y * unit_y + v.z * unit_z; }
