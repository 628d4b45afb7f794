// The techniques that can draw, by name: the program's own, and those that it is extended by.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "renderers/technique.h"
#include "scene/technique_info.h"

namespace thunderhead::renderers {

class TechniqueRegistry {
 public:
  // With the program's own techniques; what they prepare on the CPU is kept in the registry.
  static TechniqueRegistry BuiltIn();

  // ALREADY_EXISTS if there is one of its name.
  absl::Status Add(std::shared_ptr<const TechniqueFactory> technique);

  // Null if there is none of that name.
  const TechniqueFactory* Find(std::string_view name) const;

  // In the order in which to offer them.
  const std::vector<std::shared_ptr<const TechniqueFactory>>& All() const { return techniques_; }

  // The names and capabilities of all, in that order.
  std::vector<scene::TechniqueInfo> Infos() const;

  // For the scenes of every technique; null if none ever waits.
  std::shared_ptr<Preparation> PreparationOfScenes() const;

 private:
  std::vector<std::shared_ptr<const TechniqueFactory>> techniques_;
};

}  // namespace thunderhead::renderers
