#include "renderers/content.h"

#include <algorithm>

namespace thunderhead::renderers {

void AddNotShown(const scene::Scene& scene, const scene::Capabilities& shows, Content* content) {
  using Code = scene::NotShown::Code;
  const bool has_detail = std::any_of(
      content->fields.begin(), content->fields.end(), [&](physics::Hydrometeor hydrometeor) {
        return scene.fields[physics::IndexOf(hydrometeor)].detail.share > 0.0F;
      });
  if (has_detail && shows.detail == scene::DetailUse::kNone) {
    content->not_shown.push_back({Code::kDetail, "turbulent detail finer than the grid"});
  }
  if (!scene.lights.empty() && !shows.lights) {
    content->not_shown.push_back(
        {Code::kLights, "lights in addition to the sun (metaballs and the reference show them)"});
  }
  if (scene.ground.borders && !content->ground.borders) {
    content->not_shown.push_back(
        {Code::kBorders,
         "coasts and borders (the storm has no map projection, or the server has no data for them: "
         "install Debian's package gmt-gshhg-low)"});
  }
}

}  // namespace thunderhead::renderers
