// An available technique as it is told to clients.
#pragma once

#include <string>
#include <vector>

#include "scene/capabilities.h"
#include "scene/technique.h"

namespace thunderhead::scene {

struct TechniqueInfo {
  std::string name;
  Capabilities capabilities;
};

// Those of scene::Technique that have a message of their own, in its order.
std::vector<TechniqueInfo> TechniquesOfTheSchema();

}  // namespace thunderhead::scene
