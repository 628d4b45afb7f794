// The available techniques by name: those built into the program, and those added as extensions.
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
  // Creates a registry with the built-in techniques. The registry owns the techniques, and with
  // them the results of preparations, such as fits of metaballs.
  static TechniqueRegistry BuiltIn();

  // Adds a technique. Returns ALREADY_EXISTS if the registry has a technique of the same name.
  absl::Status Add(std::shared_ptr<const TechniqueFactory> technique);

  // Returns null if there is no technique with that name.
  const TechniqueFactory* Find(std::string_view name) const;

  // Returns the techniques in the order in which clients list them.
  const std::vector<std::shared_ptr<const TechniqueFactory>>& All() const { return techniques_; }

  // Returns the names and capabilities of all techniques, in the order of All.
  std::vector<scene::TechniqueInfo> Infos() const;

  // Returns one preparation for the scenes of all techniques, or null if no technique needs
  // preparation.
  std::shared_ptr<Preparation> PreparationOfScenes() const;

 private:
  std::vector<std::shared_ptr<const TechniqueFactory>> techniques_;
};

}  // namespace thunderhead::renderers
