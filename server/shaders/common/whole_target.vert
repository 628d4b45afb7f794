// Draws one triangle that covers the whole target. `position` ranges from (-1, -1) to (1, 1).
out vec2 position;

void main() {
  position = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(position, 0.0, 1.0);
}
