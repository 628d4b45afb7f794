// The data of the balls, which all passes use. Coordinates are metres from the middle of the balls' box.
#include "metaball/bindings.glsl"

struct Ball {
  vec4 middle_radius;  // xyz: middle; w: radius; in metres
  // Values at the centre in 1/m: extinction along the eye's ray (x), along the sun's ray (y), and
  // similarity scaled (z). With PAPER, x is an optical depth (paper_depth). w is unused.
  vec4 optics;
  vec4 scattering[2];  // for each group, its scattering divided by the ball's extinction for the eye
  vec4 tint;  // rgb: the albedo for each colour
};

layout(std430, binding = kBallsBinding) readonly buffer Balls { Ball balls[]; };
// Indices of the balls in drawing order.
layout(std430, binding = kBallOrderBinding) readonly buffer Order { uint order[]; };

// Returns the optical depth of the ball where its field is 1, which is tau rho in P. Man, "Generating and Real-Time
// Rendering of Clouds". Only for PAPER.
float paper_depth(Ball ball) { return ball.optics.x; }
