#include "renderers/render_settings.h"

#include "base/status.h"

namespace thunderhead::renderers {

const scene::MediumSettings& RenderSettings::Medium() const {
  const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
  THUNDERHEAD_CHECK(medium != nullptr, "a technique without a medium");
  return *medium;
}

}  // namespace thunderhead::renderers
