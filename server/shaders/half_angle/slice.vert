// A vertex of a slice's polygon, in metres from the middle of the medium's box.
layout(location = 0) in vec3 position_m;

uniform mat4 clip_from_local;

out vec3 local_m;

void main() {
  local_m = position_m;
  gl_Position = clip_from_local * vec4(position_m, 1.0);
}
