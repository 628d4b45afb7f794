// The list of the program's own techniques, in the order in which clients offer them.
#include "base/status.h"
#include "renderers/cumulus/cumulus_technique.h"
#include "renderers/half_angle/half_angle_technique.h"
#include "renderers/light_volume/light_volume_technique.h"
#include "renderers/metaball/metaball_technique.h"
#include "renderers/technique_registry.h"

namespace thunderhead::renderers {
namespace {

// Traced on the CPU beside the renderers, for sessions that choose it (session/truth_source.h).
class ReferenceFactory final : public TechniqueFactory {
 public:
  std::string_view Name() const override { return scene::Reference::kName; }
  scene::Capabilities Capabilities() const override { return scene::Reference::kCapabilities; }
  std::unique_ptr<Technique> Make(Workspace& /*workspace*/) const override { return nullptr; }
};

}  // namespace

TechniqueRegistry TechniqueRegistry::BuiltIn() {
  TechniqueRegistry registry;
  for (auto&& technique :
       {MakeLightVolumeFactory(), MakeHalfAngleFactory(), MakeMetaballFactory(),
        MakeCumulusFactory(), std::shared_ptr<const TechniqueFactory>(new ReferenceFactory())}) {
    const absl::Status added = registry.Add(technique);
    THUNDERHEAD_CHECK(added.ok(), std::string(added.message()));
  }
  return registry;
}

}  // namespace thunderhead::renderers
