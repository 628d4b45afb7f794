// Texture units, bindings of storage buffers and the layout of the data of paths/trace.comp. The file compiles as GLSL
// and as C++ (device_paths/bindings.h).
const int kPathExtinctionUnit = 0;
const int kPathMajorantUnit = 1;
const int kPathGroupsUnit = 2;  // also the next unit
const int kPathStatesBinding = 0;
const int kPathListBinding = 1;  // paths that continue
const int kPathNextListBinding = 2;  // paths that continue in the next pass
const int kPathGroupsBinding = 3;
const int kPathPhasesBinding = 4;
const int kPathLightsBinding = 5;

// Number of invocations in a work group, and number of events of a path in a pass. An event is a free flight and what
// happens at its end.
const int kPathGroupSize = 64;
const int kPathEvents = 16;

// The next step of a path, or the way in which it ended.
const int kPathMeets = 0;  // flies to a particle; the result is only the distance, or -1 if it meets no particle
const int kPathShines = 1;  // goes straight to infinity; the result is only the transmittance
const int kPathFlies = 2;
const int kPathScatters = 3;  // is at a particle
const int kPathTries = 4;  // flies, and counts only if it meets a particle of the medium
const int kPathEnded = 5;
const int kPathEscaped = 6;  // left the medium to the sky
const int kPathMissed = 7;  // was at kPathTries and did not meet a particle of the medium

// The length of an unlimited path in metres.
const float kEndlessPath_m = 3e38F;

// Number of intervals of a tabulated phase function. A table holds the function's values and its cumulative
// distribution at the ends of the intervals. For kPhaseIntervals equal steps of the cumulative distribution, it also
// holds the interval at which the search begins.
const int kPhaseIntervals = 8192;
