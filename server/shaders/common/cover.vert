// Draws the areas that a cover marks.
layout(location = 0) in vec3 position;

void main() { gl_Position = vec4(position, 1.0); }
