// The data of the balls that all passes use. Coordinates are metres from the middle of their box.
#include "metaball/bindings.glsl"

struct Ball {
  vec4 middle_radius;   // metres
  // At the centre, 1/m: extinction of the eye's ray, of the sun's, similarity scaled; and the albedo.
  vec4 optics;
  vec4 scattering[2];  // by group: scattering over the eye's extinction
  vec4 tint;            // rgb: the albedo's colour
};

layout(std430, binding = kBallsBinding) readonly buffer Balls { Ball balls[]; };
layout(std430, binding = kBallOrderBinding) readonly buffer Order { uint order[]; };  // order of drawing

// PAPER: returns the optical depth of the ball where its field is 1, Man's tau rho.
float paper_depth(Ball ball) { return ball.optics.x; }
