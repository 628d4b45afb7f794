// Texture units, bindings of storage buffers and the layout of paths/trace.comp's data. Compiles as GLSL and as C++
// (device_paths/bindings.h).
const int kPathExtinctionUnit = 0;
const int kPathMajorantUnit = 1;
const int kPathGroupsUnit = 2;  // and the one after
const int kPathStatesBinding = 0;
const int kPathListBinding = 1;      // of the paths that go on
const int kPathNextListBinding = 2;  // the same after this pass
const int kPathGroupsBinding = 3;
const int kPathPhasesBinding = 4;
const int kPathLightsBinding = 5;

// Invocations in a work group, and events of a path (a free flight and what is at its end) in a pass.
const int kPathGroupSize = 64;
const int kPathEvents = 16;

// The next step of a path, or its end.
const int kPathMeets = 0;     // flies up to where it meets a particle: its distance, or -1, and no more
const int kPathShines = 1;    // straight to infinity: its transmittance, and no more
const int kPathFlies = 2;
const int kPathScatters = 3;  // is at a particle
const int kPathTries = 4;     // flies, and counts only if it meets the medium
const int kPathEnded = 5;
const int kPathEscaped = 6;   // to the sky
const int kPathMissed = 7;    // tried, and did not meet the medium

// The length of a path that nothing ends, metres.
const float kEndlessPath_m = 3e38F;

// Intervals of a tabulated phase function. A table has its values and its cumulative distribution at their ends, and the interval at
// which the search for each of as many shares begins.
const int kPhaseIntervals = 8192;
