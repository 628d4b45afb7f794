// Rays of sunlight, one for each texel of the light buffer. This file needs common/medium.glsl and common/bricks.glsl.
uniform vec3 towards_sun;
uniform vec3 slice_normal;
uniform float first_plane_m;  // distance of the first slice's plane from the middle of the box, along the normal
uniform float spacing_m;
uniform float light_path_m;   // length of a sun ray between two slices
// Vector from the buffer's middle to its right edge; light_up_m is the vector to its upper edge.
uniform vec3 light_right_m;
uniform vec3 light_up_m;

// A sun ray's path through the slices. The ray meets slice i, counted from 0, at the distance first_m + i *
// light_path_m.
struct SunRay {
  MediumRay medium;
  float first_m;
  vec2 inside;  // distances between which the path is in the medium's box
};

// Returns the sun ray of the texel at `place`, which ranges from (0, 0) to (1, 1).
SunRay sun_ray(vec2 place) {
  vec2 across = 2.0 * place - 1.0;
  vec3 origin_m = across.x * light_right_m + across.y * light_up_m;
  vec3 direction = safe_direction(-towards_sun);
  SunRay ray;
  ray.medium = medium_ray(origin_m, direction);
  ray.first_m = (dot(slice_normal, origin_m) - first_plane_m) / dot(slice_normal, towards_sun);
  ray.inside = path_in_medium(origin_m, direction, 0.0);
  return ray;
}
