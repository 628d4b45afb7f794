// The factory of the light volume technique for the registry (technique_registry.h).
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeLightVolumeFactory();

}  // namespace thunderhead::renderers
