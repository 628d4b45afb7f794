// The variants of the metaballs' shaders.
#pragma once

#include "gl/program.h"

namespace thunderhead::renderers {

// Variant of metaball/light.comp.
struct BallLightVariant {
  gl::DefineValue paper;    // transport as printed in the paper
  gl::DefineValue pass;     // 0 splats, 1 computes the light scattered many times
  gl::DefineValue diffuse;  // the light of sky and ground instead of a beam

  gl::Defines Defines() const { return {{"PAPER", paper}, {"PASS", pass}, {"DIFFUSE", diffuse}}; }
};

// Variant of metaball/source.comp.
struct BallSourceVariant {
  gl::DefineValue lights;  // number of beams
  gl::DefineValue groups;
  gl::DefineValue colored;    // groups have colours
  gl::DefineValue paper;      // transport as printed in the paper
  gl::DefineValue isotropic;  // isotropic phase function
  gl::DefineValue parallel;   // parallel view rays

  gl::Defines Defines() const {
    return {{"LIGHTS", lights},    {"GROUPS", groups},
            {"COLORED", colored},  {"CONSISTENT", paper == 0 ? 1 : 0},
            {"PAPER", paper},      {"ISOTROPIC", isotropic},
            {"PARALLEL", parallel}};
  }
};

// Variant of metaball/splat.frag.
struct SplatVariant {
  gl::DefineValue paper;   // transport as printed in the paper
  gl::DefineValue ground;  // ground may hide balls
  gl::DefineValue detail;  // surfaces have noise

  gl::Defines Defines() const { return {{"PAPER", paper}, {"GROUND", ground}, {"DETAIL", detail}}; }
};

}  // namespace thunderhead::renderers
