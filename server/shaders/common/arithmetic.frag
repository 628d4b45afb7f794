// Computes arithmetic only, to measure how fast a device runs fragment shaders.
in vec2 position;
out vec4 sums;

void main() {
  vec4 x = vec4(position, position.yx);
  sums = vec4(0.0);
  for (int i = 0; i < 256; ++i) {
    x = fract(x * 1.618 + 0.1 * sums.wxyz);
    sums = 0.99 * sums + x * x;
  }
}
