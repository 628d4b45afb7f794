// The list of the built-in techniques, in the order in which clients show them.
#include "base/status.h"
#include "renderers/cumulus/cumulus_technique.h"
#include "renderers/half_angle/half_angle_technique.h"
#include "renderers/light_volume/light_volume_technique.h"
#include "renderers/metaball/metaball_technique.h"
#include "renderers/reference/reference_technique.h"
#include "renderers/technique_registry.h"

namespace thunderhead::renderers {

TechniqueRegistry TechniqueRegistry::BuiltIn() {
  TechniqueRegistry registry;
  for (auto&& technique : {MakeLightVolumeFactory(), MakeHalfAngleFactory(), MakeMetaballFactory(),
                           MakeCumulusFactory(), MakeReferenceFactory()}) {
    const absl::Status added = registry.Add(technique);
    THUNDERHEAD_CHECK(added.ok(), std::string(added.message()));
  }
  return registry;
}

}  // namespace thunderhead::renderers
