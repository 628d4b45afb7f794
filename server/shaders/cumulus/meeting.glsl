// The intersection of the fragment's ray with its bubble. Variants: BASE (the surface is cut off below base_m), GROUND
// (the parts that the ground hides are omitted).
#include "common/ground_distance.glsl"
#include "common/view.glsl"
#include "cumulus/bubble.glsl"

uniform vec2 per_pixel;  // 2 divided by the target's size in pixels
uniform float base_m;

flat in vec4 unit_x;
flat in vec3 unit_y;
flat in vec3 unit_z;
flat in vec3 centre_m;
flat in int index;

struct Meeting {
  vec3 origin_m;
  vec3 ray;
  float entry_m;  // distance along the ray; 0 if the ray starts inside the bubble
  float exit_m;
  float depth_m;  // depth below the surface at the ray's deepest point
  vec3 normal;  // normal of the surface at the entry
};

// Computes the intersection. Returns false if the ray misses the bubble.
bool meet(out Meeting meeting) {
  vec2 place = gl_FragCoord.xy * per_pixel - 1.0;
  meeting.ray = ray_direction(place);
  meeting.origin_m = ray_origin(place);
  vec3 o = to_unit(unit_x.xyz, unit_y, unit_z, meeting.origin_m - centre_m);
  vec3 d = to_unit(unit_x.xyz, unit_y, unit_z, meeting.ray);
  // The quadratic is solved from the ray's point nearest to the bubble's middle. Solved from the ray's origin, its
  // discriminant would suffer from cancellation for small bubbles far away.
  float square = dot(d, d);
  float nearest_m = -dot(o, d) / square;
  vec3 nearest = o + nearest_m * d;
  float inside = 1.0 - dot(nearest, nearest);
  if (inside <= 0.0) return false;
  float half_m = sqrt(inside / square);
  float entry_m = max(nearest_m - half_m, 0.0);
  float exit_m = nearest_m + half_m;
#if BASE
  float rise = abs(meeting.ray.z) < 1e-7 ? 1e-7 : meeting.ray.z;
  float at_base_m = (base_m - meeting.origin_m.z) / rise;
  if (rise > 0.0) entry_m = max(entry_m, at_base_m); else exit_m = min(exit_m, at_base_m);
#endif
  if (exit_m <= entry_m) return false;
  if (entry_m > until_ground(entry_m)) return false;
  meeting.entry_m = entry_m;
  meeting.exit_m = exit_m;
  // In the unit ball, surfaces of constant depth are spheres around the centre. The gradient of the
  // distance from the centre converts the depth to metres.
  vec3 deepest = o + clamp(nearest_m, entry_m, exit_m) * d;
  float away = max(length(deepest), 1e-6);
  vec3 gradient = from_unit_normal(unit_x.xyz, unit_y, unit_z, deepest) / away;
  meeting.depth_m = (1.0 - away) / max(length(gradient), 1e-30);
  vec3 at_entry = o + entry_m * d;
  meeting.normal = normalize(from_unit_normal(unit_x.xyz, unit_y, unit_z, at_entry));
#if BASE
  if (rise > 0.0 && entry_m == at_base_m) meeting.normal = vec3(0.0, 0.0, -1.0);
  meeting.depth_m = min(meeting.depth_m, meeting.origin_m.z + (rise > 0.0 ? exit_m : entry_m) * meeting.ray.z - base_m);
#endif
  if (entry_m == 0.0) meeting.normal = -meeting.ray;
  return true;
}
