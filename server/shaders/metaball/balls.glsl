// The balls as the passes share them. Coordinates are metres from the middle of their box.
#include "metaball/bindings.glsl"

struct Ball {
  vec4 middle_radius;   // metres
  vec4 optics;          // in the middle, 1/m: extinction of the eye's ray, of the sun's, similarity scaled; and the albedo
  vec4 scattering[2];   // by group: scattering over the eye's extinction
  vec4 tint;            // rgb: the albedo's colour
};

layout(std430, binding = kBallsBinding) readonly buffer Balls { Ball balls[]; };
layout(std430, binding = kBallOrderBinding) readonly buffer Order { uint order[]; };  // of drawing

// PAPER: optical depth of the ball where its field is 1, Man's tau rho.
float paper_depth(Ball ball) { return ball.optics.x; }
