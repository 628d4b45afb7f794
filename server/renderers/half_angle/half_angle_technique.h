// The factory of the half-angle slicing technique for the registry (technique_registry.h).
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeHalfAngleFactory();

}  // namespace thunderhead::renderers
