#include "accuracy/setting.h"

#include <cmath>
#include <tuple>

#include "accuracy/named_settings.h"

namespace thunderhead::accuracy {

Setting SettingOf(const scene::Scene& scene) {
  const scene::Rendering& rendering = scene.rendering;
  Setting setting{rendering.technique, rendering.image_scale, scene.output.jpeg_quality};
  if (scene::TracedLightOf(rendering.technique) != scene::TracedLight::kOff) {
    setting.million_paths = kTracedPaths / 1e6;
  }
  return setting;
}

Setting Untraced(Setting setting) {
  setting.million_paths = 0.0;
  return setting;
}

bool SameModel(const scene::Technique& a, const scene::Technique& b) {
  const auto key = [](const scene::Technique& technique) {
    const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
    return std::tuple(scene::NameOf(technique), TransportNameOf(technique),
                      medium == nullptr || scene::IsTranslucent(medium->transport),
                      scene::FieldLookOf(technique).per_field_phase);
  };
  return key(a) == key(b);
}

bool SameDrawing(const Setting& a, const Setting& b) {
  return SameModel(a.technique, b.technique) &&
         scene::CountOf(a.technique) == scene::CountOf(b.technique) &&
         a.image_scale == b.image_scale && (a.million_paths > 0.0) == (b.million_paths > 0.0);
}

double Distance(const Setting& a, const Setting& b) {
  return std::abs(std::log2(static_cast<double>(scene::CountOf(a.technique)) /
                            scene::CountOf(b.technique))) +
         std::abs(std::log2(a.image_scale / b.image_scale));
}

}  // namespace thunderhead::accuracy
