// The factory of the path-traced reference for the registry (technique_registry.h). The reference
// is traced on the CPU outside the renderers, for sessions that choose it
// (drawing/reference_source.h).
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeReferenceFactory();

}  // namespace thunderhead::renderers
