// Image units and bindings of storage buffers that metaballs use in addition to common/bindings.glsl. The file compiles
// as GLSL and as C++ (renderers/metaball/bindings.h).
const int kBallLightImage = 0;
const int kBallsBinding = 0;
const int kBallArrivedBinding = 1;
const int kBallOrderBinding = 2;
const int kBallSourcesBinding = 3;
const int kBallTilesBinding = 4;

// Invocations in a work group.
const int kBallGroupSize = 64;
