#include "desktop/field_colors.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::desktop {
namespace {

float Encode(float linear) {
  constexpr float kKnee = 0.0031308F;
  const float share = std::clamp(linear, 0.0F, 1.0F);
  return share <= kKnee ? 12.92F * share : 1.055F * std::pow(share, 1.0F / 2.4F) - 0.055F;
}

float Decode(float encoded) {
  constexpr float kKnee = 0.04045F;
  const float share = std::clamp(encoded, 0.0F, 1.0F);
  return share <= kKnee ? share / 12.92F : std::pow((share + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

ScreenColor ScreenColorOf(const v1::Color& linear) {
  return {Encode(linear.red()), Encode(linear.green()), Encode(linear.blue())};
}

v1::Color LinearColorOf(const ScreenColor& color) {
  v1::Color linear;
  linear.set_red(Decode(color[0]));
  linear.set_green(Decode(color[1]));
  linear.set_blue(Decode(color[2]));
  return linear;
}

bool DrawsFalseColors(const v1::Scene& scene, const v1::GetServerInfoResponse& server) {
  const v1::Rendering& rendering = scene.rendering();
  const auto* const technique =
      v1::Rendering::descriptor()->FindFieldByNumber(static_cast<int>(rendering.technique_case()));
  if (technique == nullptr || technique->message_type() == nullptr) return false;
  const bool shown =
      std::any_of(server.techniques().begin(), server.techniques().end(),
                  [&](const v1::TechniqueDescription& each) {
                    return each.name() == technique->name() && each.shows_field_optics();
                  });
  const auto* const setting = technique->message_type()->FindFieldByName("false_colors");
  if (!shown || setting == nullptr) return false;
  const auto& settings = rendering.GetReflection()->GetMessage(rendering, technique);
  return settings.GetReflection()->GetBool(settings, setting);
}

}  // namespace thunderhead::desktop
