// The view ray of a place in the picture, for perspective and for parallel rays (scene/view.h).
uniform vec3 ray_origin_m;  // origin of the ray through the picture's middle
uniform vec3 ray_origin_right_m;  // change of the ray's origin from x = 0 to x = 1
uniform vec3 ray_origin_up_m;
uniform vec3 ray_forward;
uniform vec3 ray_right;  // change of the ray's direction from x = 0 to x = 1
uniform vec3 ray_up;

// Return the ray's origin and direction. `place` ranges from (-1, -1) at the lower left to (1, 1) at the upper right.
vec3 ray_origin(vec2 place) { return ray_origin_m + place.x * ray_origin_right_m + place.y * ray_origin_up_m; }

vec3 ray_direction(vec2 place) { return normalize(ray_forward + place.x * ray_right + place.y * ray_up); }
