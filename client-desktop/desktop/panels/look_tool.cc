// Quality in words, what the picture misses, colours, exposure, sky and ground.
#include <google/protobuf/util/message_differencer.h>
#include <imgui.h>

#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/scene_edits.h"

namespace thunderhead::desktop {
namespace {

constexpr std::array<v1::Preset, 3> kQualities{v1::PRESET_FAST, v1::PRESET_BALANCED,
                                               v1::PRESET_TRUE};

bool HasGoal(const v1::Scene& scene) {
  return scene.accuracy().limit_case() != v1::Accuracy::LIMIT_NOT_SET;
}

// The server replaces a preset by what it stands for. -1 for none of the three, or while an
// accuracy goal overrides it.
int QualityOf(const Ui& ui) {
  if (HasGoal(ui.state.scene)) return -1;
  const v1::Rendering& rendering = ui.state.scene.rendering();
  for (int i = 0; i < static_cast<int>(kQualities.size()); ++i) {
    const v1::Preset preset = kQualities.at(static_cast<std::size_t>(i));
    if (rendering.has_preset() && rendering.preset() == preset) return i;
    for (const v1::PresetDescription& each : ui.storms.server.presets()) {
      if (each.preset() == preset &&
          google::protobuf::util::MessageDifferencer::Equals(each.rendering(), rendering)) {
        return i;
      }
    }
  }
  return -1;
}

void DrawQuality(Ui& ui) {
  int quality = QualityOf(ui);
  if (Segments("quality", {"Fast", "Balanced", "True"}, quality)) {
    const v1::Preset preset = kQualities.at(static_cast<std::size_t>(quality));
    ui.Edit("rendering", [=](v1::Scene& scene) { ChoosePreset(scene, preset); });
  }
  const std::array<const char*, 4> words{
      HasGoal(ui.state.scene) ? "Set by the accuracy goal, which is among every setting (X)."
                              : "Custom: as every setting (X) says.",
      "Fewer samples and no fine detail.", "Fine detail; traced light while it rests.",
      "As Balanced; files wait for traced light."};
  Quiet(words.at(static_cast<std::size_t>(quality + 1)));
  std::string missing;
  for (const v1::NotShown& each : ui.frame.modelled().not_shown()) {
    absl::StrAppend(&missing, missing.empty() ? "Not shown: " : ", ", each.message());
  }
  if (!missing.empty()) Quiet(missing + ".");
}

// Each technique has these settings under its own name, or not at all.
void DrawTechniqueSettings(Ui& ui) {
  const v1::Rendering& rendering = ui.state.scene.rendering();
  const auto* const field =
      v1::Rendering::descriptor()->FindFieldByNumber(static_cast<int>(rendering.technique_case()));
  if (field == nullptr) return;
  const std::string path = absl::StrCat("rendering.", field->name(), ".");
  Setting(ui, path + "detail", "Detail finer than the grid");
  Setting(ui, path + "false_colors", "False colours");
}

void DrawExposure(Ui& ui) {
  bool automatic = !ui.state.scene.display().has_exposure_ev();
  const float shown_ev = std::round(100.0F * ui.frame.modelled().exposure_ev()) / 100.0F;
  if (ImGui::Checkbox("Automatic exposure", &automatic)) {
    ui.Edit("display.exposure_ev", [=](v1::Scene& scene) {
      v1::Display& display = *scene.mutable_display();
      automatic ? display.clear_exposure_ev() : display.set_exposure_ev(shown_ev);
    });
  }
  ImGui::BeginDisabled(automatic);
  double exposure_ev = automatic ? shown_ev : ui.state.scene.display().exposure_ev();
  if (Slider("Exposure, stops", client::LimitsOf<v1::Display>("exposure_ev"), exposure_ev)) {
    ui.Edit("display.exposure_ev", [=](v1::Scene& scene) {
      scene.mutable_display()->set_exposure_ev(static_cast<float>(exposure_ev));
    });
  }
  ImGui::EndDisabled();
}

}  // namespace

void LookTool(Ui& ui) {
  ImGui::BeginDisabled(!ui.state.Steers());
  DrawQuality(ui);
  ImGui::Spacing();
  DrawTechniqueSettings(ui);
  DrawExposure(ui);
  Setting(ui, "display.tone_map", "Tone map");
  Setting(ui, "ground.cover", "Ground");
  Setting(ui, "sky.ground_albedo", "Albedo of the ground");
  Setting(ui, "display.white_balance", "White balance");
  Setting(ui, "ground.rings", "Rings every 10 km");
  ImGui::EndDisabled();
}

}  // namespace thunderhead::desktop
