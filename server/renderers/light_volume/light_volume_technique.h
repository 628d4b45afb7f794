// The light volume as a technique of the registry.
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeLightVolumeFactory();

}  // namespace thunderhead::renderers
