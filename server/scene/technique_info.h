// An available technique as it is told to clients.
#pragma once

#include <string>

#include "scene/capabilities.h"

namespace thunderhead::scene {

struct TechniqueInfo {
  std::string name;
  Capabilities capabilities;
};

}  // namespace thunderhead::scene
