// The tool "Look": quality, the effects that the picture does not simulate, colours, exposure, sky
// and ground, and the required accuracy or speed. It also offers the presets that draw a picture as
// a paper does.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/scene_edits.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

constexpr std::array<v1::Preset, 3> kQualities{v1::PRESET_FAST, v1::PRESET_BALANCED,
                                               v1::PRESET_ACCURATE};

std::string WordsOf(const v1::Scene& scene, v1::Preset preset) {
  switch (preset) {
    case v1::PRESET_FAST:
      return "Fewer samples and no fine detail.";
    case v1::PRESET_BALANCED:
      return "Fine detail; path-traced correction while it rests.";
    case v1::PRESET_ACCURATE:
      return "Four times the samples of Balanced; files wait for the path-traced correction.";
    case v1::PRESET_UNSPECIFIED:
      return scene.accuracy().limit_case() == v1::Accuracy::LIMIT_NOT_SET
                 ? "Custom: as set under Every setting (X)."
                 : "Set by the goal below.";
    default:
      return absl::StrCat("As in the paper: ", NameOf(preset), ".");
  }
}

void Choose(Ui& ui, v1::Preset preset) {
  ui.Edit("rendering", [=](v1::Scene& scene) { ChoosePreset(scene, preset); });
}

void DrawQuality(Ui& ui, v1::Preset preset) {
  const auto* const found = std::find(kQualities.begin(), kQualities.end(), preset);
  int quality = found == kQualities.end() ? -1 : static_cast<int>(found - kQualities.begin());
  if (Segments("quality", {"Fast", "Balanced", "Accurate"}, quality)) {
    Choose(ui, kQualities.at(static_cast<std::size_t>(quality)));
  }
  Quiet(WordsOf(ui.state.scene, preset));
  std::string missing;
  for (const v1::NotShown& each : ui.frame.modelled().not_shown()) {
    absl::StrAppend(&missing, missing.empty() ? "Not shown: " : ", ", each.message());
  }
  if (!missing.empty()) Quiet(missing + ".");
}

// Draws the choice of the accuracy or speed that the server must reach.
void DrawGoal(Ui& ui) {
  int goal = ui.state.scene.accuracy().limit_case();
  if (Choice("Accuracy",
             {{v1::Accuracy::LIMIT_NOT_SET, "Same as the quality"},
              {v1::Accuracy::kMaxError, "At most this error"},
              {v1::Accuracy::kMaxMilliseconds, "At most this time per frame"}},
             goal)) {
    ui.Edit("accuracy", [=](v1::Scene& scene) {
      ChooseGoal(scene, static_cast<v1::Accuracy::LimitCase>(goal));
    });
  }
  // The scene has only the parameter of the chosen goal, so at most one of these two controls is
  // drawn.
  Setting(ui, "accuracy.max_error", "Error");
  Setting(ui, "accuracy.max_milliseconds", "Time");
  if (ui.frame.accuracy().has_unmet()) Quiet(ui.frame.accuracy().unmet().message() + ".");
}

void DrawPapersModes(Ui& ui, v1::Preset preset) {
  std::vector<std::pair<int, std::string>> options{
      {v1::PRESET_UNSPECIFIED, NameOf(v1::PRESET_UNSPECIFIED)}};
  for (const v1::PresetDescription& each : ui.storms.server.presets()) {
    if (!IsQuality(each.preset())) options.emplace_back(each.preset(), NameOf(each.preset()));
  }
  int mode = IsQuality(preset) ? v1::PRESET_UNSPECIFIED : preset;
  if (Choice("Papers' settings", options, mode) && mode != v1::PRESET_UNSPECIFIED) {
    Choose(ui, static_cast<v1::Preset>(mode));
  }
}

// Draws the settings that the scene stores in the message of its technique. Not every technique has
// every setting.
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
  const v1::Preset preset = PresetOf(ui.state.scene, ui.storms.server);
  DrawQuality(ui, preset);
  ImGui::Spacing();
  DrawTechniqueSettings(ui);
  DrawExposure(ui);
  Setting(ui, "display.tone_map", "Tone map");
  Setting(ui, "ground.cover", "Ground");
  Setting(ui, "sky.ground_albedo", "Albedo of the ground");
  Setting(ui, "display.white_balance", "White balance");
  ImGui::SameLine();
  Setting(ui, "ground.borders", "Coasts and borders");
  Setting(ui, "ground.rings", "Rings every 10 km");
  DrawGoal(ui);
  DrawPapersModes(ui, preset);
  ImGui::EndDisabled();
}

}  // namespace thunderhead::desktop
