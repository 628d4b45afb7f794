// Makes descriptions of the techniques for tests of messages. These tests do not link the code that
// renders.
#pragma once

#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "scene/technique.h"
#include "scene/technique_info.h"

namespace thunderhead::test_support {

// Returns descriptions of the techniques in scene::Technique that have their own Protobuf message,
// in the order of scene::Technique.
inline std::vector<scene::TechniqueInfo> TechniquesOfTheSchema() {
  std::vector<scene::TechniqueInfo> infos;
  const auto add = [&]<typename Kind>(std::type_identity<Kind>) {
    if constexpr (!std::is_same_v<Kind, scene::OtherTechnique>) {
      infos.push_back({std::string(Kind::kName), Kind::kCapabilities});
    }
  };
  [&]<typename... Kinds>(std::type_identity<std::variant<Kinds...>>) {
    (add(std::type_identity<Kinds>{}), ...);
  }(std::type_identity<scene::Technique>{});
  return infos;
}

}  // namespace thunderhead::test_support
