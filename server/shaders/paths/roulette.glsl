// Thresholds of Russian roulette for random paths, both on the CPU (reference/roulette.h) and on the device
// (paths/trace.comp). The file compiles as GLSL and as C++.

// Beyond this optical depth, light continues by roulette. Computing exact transmittances of 0.1 and less takes more
// time than it saves in noise. Work times variance of paths is a tenth larger with 2.3 and a third larger with 5.
const float kRouletteDepth = 1.0F;

// Below this throughput, paths continue by roulette.
const float kRouletteThroughput = 0.1F;

// In thick clouds of high albedo, the number of paths with more than n collisions decreases only as 1 / sqrt(n). A few
// very long paths would take most of the time. At this many collisions, and each time that number quadruples, paths
// survive with probability 1/2. That balances work and variance over path lengths.
const int kLongPath = 64;

// Sunlight with a smaller contribution, relative to isotropic scattering, is sampled by roulette.
const float kRouletteSunlight = 0.5F;
