// Where random paths go on by Russian roulette, on processors (reference/roulette.h) and device (paths/trace.comp) alike. Compiles
// as GLSL and as C++.

// Beyond this optical depth light goes on by roulette. Exact transmittances of 0.1 and less take more time than their noise is worth:
// work times variance of paths with 2.3 is a tenth larger, with 5 a third.
const float kRouletteDepth = 1.0F;

// Below this throughput paths go on by roulette.
const float kRouletteThroughput = 0.1F;

// In thick clouds of high albedo the number of paths with more than n collisions falls only as 1 / sqrt(n): a few very long ones would
// take most of the time. At this many collisions, and each time that number quadruples, paths survive with probability 1/2, which
// balances work and variance over path lengths.
const int kLongPath = 64;

// Sunlight whose contribution, relative to isotropic scattering, is below this is sampled by roulette.
const float kRouletteSunlight = 0.5F;
