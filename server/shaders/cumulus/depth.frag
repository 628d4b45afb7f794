// Writes the distance of the nearest core, which is the part of a bubble deeper than the corona. The variants are those
// of cumulus/meeting.glsl.
#include "cumulus/meeting.glsl"

layout(depth_greater) out float gl_FragDepth;

uniform float corona_m;
uniform float per_far;  // 1 divided by the distance that depth 1 stands for

void main() {
  Meeting meeting;
  if (!meet(meeting) || meeting.depth_m < corona_m) discard;
  gl_FragDepth = meeting.entry_m * per_far;
}
