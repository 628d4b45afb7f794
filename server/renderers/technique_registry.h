// The techniques that can draw, by name: the program's own, and those added as extensions.
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
  // Creates a registry with the program's own techniques. It keeps their preparations on the CPU.
  static TechniqueRegistry BuiltIn();

  // Adds a technique. Returns ALREADY_EXISTS if there is one with its name.
  absl::Status Add(std::shared_ptr<const TechniqueFactory> technique);

  // Returns null if there is no technique with that name.
  const TechniqueFactory* Find(std::string_view name) const;

  // Returns the techniques in the order in which to offer them.
  const std::vector<std::shared_ptr<const TechniqueFactory>>& All() const { return techniques_; }

  // Returns the names and capabilities of all techniques, in that order.
  std::vector<scene::TechniqueInfo> Infos() const;

  // Returns the preparation for the scenes of every technique, or null if none needs one.
  std::shared_ptr<Preparation> PreparationOfScenes() const;

 private:
  std::vector<std::shared_ptr<const TechniqueFactory>> techniques_;
};

}  // namespace thunderhead::renderers
