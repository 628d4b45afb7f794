// The variants of half-angle slicing's shaders. The variants of thickness.comp are those of the
// medium.
#pragma once

#include "gl/program.h"
#include "renderers/half_angle/slicing.h"
#include "renderers/medium.h"

namespace thunderhead::renderers {

// Variant of half_angle/carry.comp.
struct SliceLightVariant {
  MediumVariant medium;
  gl::DefineValue consistent;   // the transport is consistent
  gl::DefineValue translucent;  // neighbouring texels exchange light

  gl::Defines Defines() const {
    return gl::Joined(medium.Defines(), {{"CONSISTENT", consistent}, {"TRANSLUCENT", translucent}});
  }
};

// Variant of half_angle/eye.frag.
struct SliceEyeVariant {
  MediumVariant medium;
  gl::DefineValue colored;      // groups have colours
  gl::DefineValue even_albedo;  // one albedo and colour for all groups
  gl::DefineValue translucent;
  gl::DefineValue consistent;  // the transport is consistent
  gl::DefineValue ground;      // ground may hide a part of the medium
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
