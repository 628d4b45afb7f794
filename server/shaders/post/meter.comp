// Measures the luminance that the brightest hundredth of the storm exceeds, in a linear frame whose
// alpha is the storm's opacity. If the frame shows almost no storm, the whole picture is measured.
// One work group divides the picture into cells and makes a histogram of the cells' means. Each
// mean omits the cell's brightest sample, so that noise and single bright pixels have no effect.
#include "common/bindings.glsl"

layout(local_size_x = kMeterGroupSize) in;
layout(binding = kLinearFrameUnit) uniform sampler2D linear_frame;
layout(binding = kMeterImage, r32f) uniform writeonly image2D brightest;

uniform vec3 luminance_weights;  // luminance weights of red, green and blue, multiplied by the white balance

const int kCells = 32;  // number of cells along each side of the picture
const int kPlaces = 3;  // number of samples in a cell along each side
const int kBins = 768;
const float kBinsPerStop = 32.0;  // a change of the exposure by one bin (1/32 stop) is not visible
const float kLowestLog2 = -18.0;
const uint kFullWeight = 255u;
const float kFewestCells = 0.001;  // minimum share of all cells that must show the storm

shared uint histogram[kBins];

void count_cell(int cell, float least_opacity) {
  vec2 corner = vec2(cell % kCells, cell / kCells);
  vec2 sum = vec2(0.0);  // sum of luminance times opacity, and of opacity
  vec2 brightest_sample = vec2(0.0);
  for (int i = 0; i < kPlaces * kPlaces; ++i) {
    vec2 within = (vec2(i % kPlaces, i / kPlaces) + 0.5) / float(kPlaces);
    vec4 pixel = textureLod(linear_frame, (corner + within) / float(kCells), 0.0);
    vec2 here = max(pixel.a, least_opacity) * vec2(max(dot(pixel.rgb, luminance_weights), 0.0), 1.0);
    sum += here;
    if (here.x > brightest_sample.x) brightest_sample = here;
  }
  sum -= brightest_sample;
  uint weight = uint(sum.y / float(kPlaces * kPlaces) * float(kFullWeight));
  if (weight == 0u) return;
  float log2_luminance = log2(max(sum.x / sum.y, 1e-9));
  int bin = clamp(int((log2_luminance - kLowestLog2) * kBinsPerStop), 0, kBins - 1);
  atomicAdd(histogram[bin], weight);
}

uint counted() {
  uint all = 0u;
  for (int bin = 0; bin < kBins; ++bin) all += histogram[bin];
  return all;
}

// Fills the histogram with all cells, each weighted by its mean opacity. Opacities below
// `least_opacity` count as `least_opacity`. All invocations must call this function.
void count(float least_opacity) {
  int first = int(gl_LocalInvocationIndex);
  for (int i = first; i < kBins; i += kMeterGroupSize) histogram[i] = 0u;
  barrier();
  for (int i = first; i < kCells * kCells; i += kMeterGroupSize) count_cell(i, least_opacity);
  barrier();
}

float brightest_hundredth() {
  uint all = counted();
  float left = 0.01 * float(all);
  for (int bin = kBins - 1; bin >= 0; --bin) {
    float here = float(histogram[bin]);
    if (here >= left) return exp2(kLowestLog2 + (float(bin + 1) - left / here) / kBinsPerStop);
    left -= here;
  }
  return 0.0;
}

void main() {
  count(0.0);
  bool no_storm = float(counted()) < kFewestCells * float(kCells * kCells) * float(kFullWeight);
  barrier();
  if (no_storm) count(1.0);
  if (gl_LocalInvocationIndex == 0u) imageStore(brightest, ivec2(0), vec4(brightest_hundredth(), 0.0, 0.0, 0.0));
}
