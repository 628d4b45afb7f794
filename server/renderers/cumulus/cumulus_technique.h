// The factory of the cumulus technique for the registry (technique_registry.h).
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeCumulusFactory();

}  // namespace thunderhead::renderers
