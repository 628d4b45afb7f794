// Rays and axis-parallel boxes.

// Returns the direction with zero components replaced by tiny ones, so that division by it is safe.
vec3 safe_direction(vec3 direction) { return mix(direction, vec3(1e-7), lessThan(abs(direction), vec3(1e-7))); }

// Returns the part of the ray that is in the box. If the ray misses the box, x > y. `direction` must come from
// safe_direction.
vec2 path_through_box(vec3 low_m, vec3 high_m, vec3 origin_m, vec3 direction) {
  vec3 a = (low_m - origin_m) / direction;
  vec3 b = (high_m - origin_m) / direction;
  vec3 nearest = min(a, b);
  vec3 farthest = max(a, b);
  return vec2(max(nearest.x, max(nearest.y, nearest.z)), min(farthest.x, min(farthest.y, farthest.z)));
}
