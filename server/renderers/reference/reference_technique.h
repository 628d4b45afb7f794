// The reference as a technique of the registry. It is traced on the CPU beside the renderers, for
// sessions that choose it (session/truth_source.h).
#pragma once

#include <memory>

#include "renderers/technique.h"

namespace thunderhead::renderers {

std::shared_ptr<const TechniqueFactory> MakeReferenceFactory();

}  // namespace thunderhead::renderers
