// Thresholds of Russian roulette for random paths, both on the CPU (reference/roulette.h) and on the device
// (paths/trace.comp). The file compiles as GLSL and as C++.

// Optical depth beyond which light continues by Russian roulette. Computing transmittances of 0.1 and less exactly
// takes more time than it saves in noise. Compared with a depth of 1, the product of work and variance of paths is a
// tenth larger with 2.3, and a third larger with 5.
const float kRouletteDepth = 1.0F;

// Throughput below which paths continue by roulette.
const float kRouletteThroughput = 0.1F;

// In thick clouds of high albedo, the number of paths with more than n collisions decreases only as 1 / sqrt(n). A few
// very long paths would take most of the time. Paths therefore survive with probability 1/2 at kLongPath collisions,
// and again each time that the number of collisions has quadrupled. This balances work and variance over all path
// lengths.
const int kLongPath = 64;

// Contribution of sunlight, relative to isotropic scattering, below which sunlight is sampled by roulette.
const float kRouletteSunlight = 0.5F;
