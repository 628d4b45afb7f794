#include "renderers/technique_registry.h"

#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::renderers {
namespace {

// A preparation that calls the preparation of the scene's technique.
class ByTechnique final : public Preparation {
 public:
  using Preparations = std::map<std::string, std::shared_ptr<Preparation>, std::less<>>;

  explicit ByTechnique(Preparations preparations) : preparations_(std::move(preparations)) {}

  bool IsNeeded(const scene::Scene& scene) const override {
    const Preparation* own = Of(scene);
    return own != nullptr && own->IsNeeded(scene);
  }

  bool IsDone(const scene::Scene& scene, const Fields& fields) override {
    Preparation* own = Of(scene);
    return own == nullptr || own->IsDone(scene, fields);
  }

  absl::Status Prepare(const scene::Scene& scene, const Fields& fields) override {
    Preparation* own = Of(scene);
    return own == nullptr ? absl::OkStatus() : own->Prepare(scene, fields);
  }

 private:
  Preparation* Of(const scene::Scene& scene) const {
    const auto found = preparations_.find(scene::NameOf(scene.rendering.technique));
    return found == preparations_.end() ? nullptr : found->second.get();
  }

  const Preparations preparations_;
};

}  // namespace

absl::Status TechniqueRegistry::Add(std::shared_ptr<const TechniqueFactory> technique) {
  if (Find(technique->Name()) != nullptr) {
    return absl::AlreadyExistsError(absl::StrCat("there is already a technique '",
                                                 std::string(technique->Name()),
                                                 "'; give the new technique another name"));
  }
  techniques_.push_back(std::move(technique));
  return absl::OkStatus();
}

const TechniqueFactory* TechniqueRegistry::Find(std::string_view name) const {
  for (const auto& technique : techniques_) {
    if (technique->Name() == name) return technique.get();
  }
  return nullptr;
}

std::vector<scene::TechniqueInfo> TechniqueRegistry::Infos() const {
  std::vector<scene::TechniqueInfo> infos;
  for (const auto& technique : techniques_) {
    infos.push_back({std::string(technique->Name()), technique->Capabilities()});
  }
  return infos;
}

std::shared_ptr<Preparation> TechniqueRegistry::PreparationOfScenes() const {
  ByTechnique::Preparations preparations;
  for (const auto& technique : techniques_) {
    if (auto own = technique->PreparationOfScenes(); own != nullptr) {
      preparations.emplace(technique->Name(), std::move(own));
    }
  }
  if (preparations.empty()) return nullptr;
  return std::make_shared<ByTechnique>(std::move(preparations));
}

}  // namespace thunderhead::renderers
