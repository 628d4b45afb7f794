// The variants of the light volume's shaders.
#pragma once

#include "gl/program.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Variant of carry.comp.
struct CarryVariant {
  gl::DefineValue consistent;   // the transport is consistent
  gl::DefineValue translucent;  // scattered light continues
  gl::DefineValue diffuse;      // multiple scattering in closed form

  gl::Defines Defines() const {
    return {{"CONSISTENT", consistent}, {"TRANSLUCENT", translucent}, {"DIFFUSE", diffuse}};
  }
};

// Variant of arrive.comp.
struct ArriveVariant {
  MediumVariant medium;
  CarryVariant carry;
  // 1: stores a depth ratio; 2: uses it instead of sampling the medium next to a cell
  gl::DefineValue near;

  gl::Defines Defines() const {
    return gl::Joined(gl::Joined(medium.Defines(), carry.Defines()), {{"NEAR", near}});
  }
};

// Variant of march.frag.
struct MarchVariant {
  MediumVariant medium;
  gl::DefineValue colored;      // groups have colours
  gl::DefineValue consistent;   // the transport is consistent
  gl::DefineValue ground;       // ground may hide a part of the medium
  gl::DefineValue even_albedo;  // one albedo and colour for all groups
  gl::DefineValue diffusion;    // multiple scattering comes from the diffusion equation
  gl::DefineValue tinted;       // this light is absorbed or coloured
  gl::DefineValue corrected;    // radiance is corrected by renderers::LightCorrection
  gl::DefineValue chosen;       // draws the rays of renderers::ChosenRays

  gl::Defines Defines() const {
    return gl::Joined(medium.Defines(), {{"COLORED", colored},
                                         {"CONSISTENT", consistent},
                                         {"GROUND", ground},
                                         {"EVEN_ALBEDO", even_albedo},
                                         {"DIFFUSION", diffusion},
                                         {"TINTED", tinted},
                                         {"CORRECTED", corrected},
                                         {"CHOSEN", chosen}});
  }
};

}  // namespace thunderhead::renderers
