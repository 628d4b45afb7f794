// The preprocessor variants of the light volume's shaders. A group is a set of fields with equal
// optics (scene/field_groups.h).
#pragma once

#include "gl/program.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Preprocessor variant of carry.comp.
struct CarryVariant {
  gl::DefineValue consistent;   // 1 unless the transport is the paper's (scene::IsPaper)
  gl::DefineValue translucent;  // 1 if light scattered forward continues
  gl::DefineValue diffuse;      // 1 if multiple scattering is computed in closed form

  gl::Defines Defines() const {
    return {{"CONSISTENT", consistent}, {"TRANSLUCENT", translucent}, {"DIFFUSE", diffuse}};
  }
};

// Preprocessor variant of arrive.comp.
struct ArriveVariant {
  MediumVariant medium;
  CarryVariant carry;
  // How the shader finds the optical depth of the path close to a cell. With 0 and 1, it samples
  // the medium along the path. With 1, it also stores the ratio of this optical depth to that in
  // the light's medium (light_medium.comp). With 2, it uses the stored ratio and does not sample
  // the medium.
  gl::DefineValue near;

  gl::Defines Defines() const {
    return gl::Joined(gl::Joined(medium.Defines(), carry.Defines()), {{"NEAR", near}});
  }
};

// Preprocessor variant of march.frag.
struct MarchVariant {
  MediumVariant medium;
  gl::DefineValue colored;      // 1 if groups have colours
  gl::DefineValue consistent;   // 1 unless the transport is the paper's (scene::IsPaper)
  gl::DefineValue ground;       // 1 if ground may hide a part of the medium
  gl::DefineValue even_albedo;  // 1 if all groups have the same albedo and no colours
  gl::DefineValue diffusion;    // 1 if multiple scattering comes from the diffusion equation
  gl::DefineValue tinted;       // 1 if light from the diffusion equation is absorbed or coloured
  gl::DefineValue corrected;    // 1 if renderers::LightCorrection corrects the radiance
  gl::DefineValue chosen;       // 1 to draw the rays of renderers::ChosenRays

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
