#include "renderers/reference/reference_technique.h"

namespace thunderhead::renderers {
namespace {

class ReferenceFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::Reference::kName; }
  scene::Capabilities Capabilities() const override { return scene::Reference::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& /*workspace*/) const override { return nullptr; }
};

}  // namespace

std::shared_ptr<const TechniqueFactory> MakeReferenceFactory() {
  return std::make_shared<ReferenceFactory>();
}

}  // namespace thunderhead::renderers
