// The preprocessor variants of the metaballs' shaders. A group is a set of fields with equal optics
// (scene/field_groups.h).
#pragma once

#include "gl/program.h"

namespace thunderhead::renderers {

// Preprocessor variant of metaball/light.comp.
struct BallLightVariant {
  gl::DefineValue paper;    // 1 for the transport as printed in the paper
  gl::DefineValue pass;     // 0 splats the balls, 1 computes the light scattered many times
  gl::DefineValue diffuse;  // 1 for the light of sky and ground instead of a beam

  gl::Defines Defines() const { return {{"PAPER", paper}, {"PASS", pass}, {"DIFFUSE", diffuse}}; }
};

// Preprocessor variant of metaball/source.comp.
struct BallSourceVariant {
  gl::DefineValue lights;  // number of beams
  gl::DefineValue groups;
  gl::DefineValue colored;    // 1 if groups have colours
  gl::DefineValue paper;      // 1 for the transport as printed in the paper
  gl::DefineValue isotropic;  // 1 for an isotropic phase function
  gl::DefineValue parallel;   // 1 for parallel view rays

  gl::Defines Defines() const {
    return {{"LIGHTS", lights},    {"GROUPS", groups},
            {"COLORED", colored},  {"CONSISTENT", paper == 0 ? 1 : 0},
            {"PAPER", paper},      {"ISOTROPIC", isotropic},
            {"PARALLEL", parallel}};
  }
};

// Preprocessor variant of metaball/splat.frag.
struct SplatVariant {
  gl::DefineValue paper;   // 1 for the transport as printed in the paper
  gl::DefineValue ground;  // 1 if ground may hide balls
  gl::DefineValue detail;  // 1 if surfaces have noise

  gl::Defines Defines() const { return {{"PAPER", paper}, {"GROUND", ground}, {"DETAIL", detail}}; }
};

}  // namespace thunderhead::renderers
