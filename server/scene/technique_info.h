// The description of an available technique that clients receive.
#pragma once

#include <string>

#include "scene/capabilities.h"

namespace thunderhead::scene {

struct TechniqueInfo {
  std::string name;
  Capabilities capabilities;
};

}  // namespace thunderhead::scene
