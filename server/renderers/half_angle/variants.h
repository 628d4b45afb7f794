// The preprocessor variants of the shaders of half-angle slicing. The variants of thickness.comp
// are those of the medium. A group is a set of fields with equal optics (scene/field_groups.h).
#pragma once

#include "gl/program.h"
#include "renderers/half_angle/slicing.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Preprocessor variant of half_angle/carry.comp.
struct SliceLightVariant {
  MediumVariant medium;
  gl::DefineValue consistent;   // 1 unless the transport is the paper's (scene::IsPaper)
  gl::DefineValue translucent;  // 1 if neighbouring texels exchange light

  gl::Defines Defines() const {
    return gl::Joined(medium.Defines(), {{"CONSISTENT", consistent}, {"TRANSLUCENT", translucent}});
  }
};

// Preprocessor variant of half_angle/eye.frag.
struct SliceEyeVariant {
  MediumVariant medium;
  gl::DefineValue colored;      // 1 if groups have colours
  gl::DefineValue even_albedo;  // 1 if all groups have the same albedo and no colours
  gl::DefineValue translucent;
  gl::DefineValue consistent;  // 1 unless the transport is the paper's (scene::IsPaper)
  gl::DefineValue ground;      // 1 if ground may hide a part of the medium
  SliceOrder order;

  gl::Defines Defines() const {
    return gl::Joined(medium.Defines(), {{"COLORED", colored},
                                         {"EVEN_ALBEDO", even_albedo},
                                         {"TRANSLUCENT", translucent},
                                         {"CONSISTENT", consistent},
                                         {"GROUND", ground},
                                         {"ORDER", static_cast<int>(order)}});
  }
};

}  // namespace thunderhead::renderers
