// The variants of the light volume's shaders.
#pragma once

#include "gl/program.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Variant of carry.comp.
struct CarryVariant {
  gl::DefineValue consistent;   // transport
  gl::DefineValue translucent;  // light that is scattered goes on
  gl::DefineValue diffuse;      // light scattered many times is found in closed form

  gl::Defines Defines() const {
    return {{"CONSISTENT", consistent}, {"TRANSLUCENT", translucent}, {"DIFFUSE", diffuse}};
  }
};

// Variant of arrive.comp.
struct ArriveVariant {
  MediumVariant medium;
  CarryVariant carry;
  gl::DefineValue near;  // 1: keeps what 2 takes in place of the medium next to a cell

  gl::Defines Defines() const {
    return gl::Joined(gl::Joined(medium.Defines(), carry.Defines()), {{"NEAR", near}});
  }
};

// Variant of march.frag.
struct MarchVariant {
  MediumVariant medium;
  gl::DefineValue colored;      // groups have colours
  gl::DefineValue consistent;   // transport
  gl::DefineValue ground;       // may hide a part of the medium
  gl::DefineValue even_albedo;  // one albedo and colour for all groups
  gl::DefineValue diffusion;    // light scattered many times comes from the diffusion equation
  gl::DefineValue tinted;       // that light is absorbed or coloured
  gl::DefineValue corrected;    // by renderers::LightCorrection
  gl::DefineValue chosen;       // the rays of renderers::ChosenRays

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
