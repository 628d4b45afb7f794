// How far the nearest core is: what lies deeper than the corona. Variants of cumulus/meeting.glsl.
#include "cumulus/meeting.glsl"

layout(depth_greater) out float gl_FragDepth;

uniform float corona_m;
uniform float per_far;  // 1 over the distance that is depth 1

void main() {
  Meeting meeting;
  if (!meet(meeting) || meeting.depth_m < corona_m) discard;
  gl_FragDepth = meeting.entry_m * per_far;
}
