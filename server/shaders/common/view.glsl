// The view ray of a place in the picture; perspective and parallel rays alike (scene/view.h).
uniform vec3 ray_origin_m;        // of the middle's ray
uniform vec3 ray_origin_right_m;  // what x = 1 adds to the origin
uniform vec3 ray_origin_up_m;
uniform vec3 ray_forward;
uniform vec3 ray_right;           // what x = 1 adds to the direction
uniform vec3 ray_up;

// `place` runs from (-1, -1), left and bottom, to (1, 1).
vec3 ray_origin(vec2 place) { return ray_origin_m + place.x * ray_origin_right_m + place.y * ray_origin_up_m; }

vec3 ray_direction(vec2 place) { return normalize(ray_forward + place.x * ray_right + place.y * ray_up); }
