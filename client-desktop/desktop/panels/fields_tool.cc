// One row for each field of the storm. It switches the field on or off, and sets its amount and the
// source of its particle sizes. If the picture shows false colours, the row also sets the field's
// colour.
#include <imgui.h>

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/field_colors.h"
#include "desktop/panels/panels.h"
#include "desktop/scene_edits.h"
#include "desktop/style.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

const v1::FieldParameters& ParametersIn(const v1::Scene& scene, const v1::FieldDescription& field) {
  for (const v1::FieldParameters& each : scene.fields()) {
    if (each.hydrometeor() == field.hydrometeor()) return each;
  }
  return field.defaults();
}

v1::FieldParameters& MutableIn(v1::Scene& scene, v1::Hydrometeor hydrometeor) {
  for (v1::FieldParameters& each : *scene.mutable_fields()) {
    if (each.hydrometeor() == hydrometeor) return each;
  }
  v1::FieldParameters& added = *scene.add_fields();
  added.set_hydrometeor(hydrometeor);
  return added;
}

// Draws a button in the field's false colour. The button opens a colour picker.
void DrawColor(Ui& ui, const v1::FieldDescription& field, const v1::FieldParameters& now,
               const std::string& subject) {
  ScreenColor color =
      ScreenColorOf(now.has_false_color() ? now.false_color() : field.defaults().false_color());
  const v1::Hydrometeor hydrometeor = field.hydrometeor();
  constexpr ImGuiColorEditFlags kFlags =
      ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel | ImGuiColorEditFlags_NoTooltip |
      ImGuiColorEditFlags_NoOptions | ImGuiColorEditFlags_NoDragDrop;
  if (ImGui::ColorEdit3("##color", color.data(), kFlags)) {
    ui.Edit(subject, [=](v1::Scene& scene) {
      *MutableIn(scene, hydrometeor).mutable_false_color() = LinearColorOf(color);
    });
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("False colour");
  ImGui::SameLine();
}

void DrawField(Ui& ui, const v1::FieldDescription& field) {
  const v1::Hydrometeor hydrometeor = field.hydrometeor();
  const v1::FieldParameters now = ParametersIn(ui.state.scene, field);
  const std::string name = NameOf(hydrometeor);
  const std::string subject = absl::StrCat("fields.", name);
  if (DrawsFalseColors(ui.state.scene, ui.storms.server)) DrawColor(ui, field, now, subject);
  bool visible = !now.has_visible() || now.visible();
  if (ImGui::Checkbox(name.c_str(), &visible)) {
    ui.Edit(subject, [=](v1::Scene& scene) { MutableIn(scene, hydrometeor).set_visible(visible); });
  }
  const bool empty = field.maximum() <= 0.0F;
  const std::string amount = empty ? "none at this time" : DescribeAmount(field);
  ImGui::PushFont(SmallFont());
  SameLineAtRight(ImGui::CalcTextSize(amount.c_str()).x);
  QuietLine(amount);
  ImGui::PopFont();
  if (empty || !visible) return;
  double scale = now.has_scale() ? now.scale() : 1.0;
  if (Slider("Amount, times the model's", client::LimitsOf<v1::FieldParameters>("scale"), scale)) {
    ui.Edit(subject, [=](v1::Scene& scene) {
      MutableIn(scene, hydrometeor).set_scale(static_cast<float>(scale));
    });
  }
}

// Draws the choice of particle sizes for all fields at once.
void DrawParticleSizes(Ui& ui) {
  const auto& fields = ui.storms.storm.fields();
  if (std::all_of(fields.begin(), fields.end(), IsExtinction)) return;
  const v1::ParticleSizes now = ui.state.scene.particle_sizes();
  int sizes = now == v1::PARTICLE_SIZES_UNSPECIFIED ? v1::PARTICLE_SIZES_MODEL : now;
  ImGui::Spacing();
  if (Choice("Particle sizes",
             {{v1::PARTICLE_SIZES_MODEL, "As the model has them"},
              {v1::PARTICLE_SIZES_PAPERS, "The papers' constants"}},
             sizes)) {
    ui.Edit("particle_sizes", [=](v1::Scene& scene) {
      ChooseParticleSizes(scene, static_cast<v1::ParticleSizes>(sizes));
    });
  }
}

}  // namespace

void FieldsTool(Ui& ui) {
  const auto& storm = ui.storms.storm;
  ImGui::BeginDisabled(!ui.state.Steers());
  if (storm.fields().empty()) Quiet("Waiting for the storm's description …");
  for (const v1::FieldDescription& field : storm.fields()) {
    ImGui::PushID(field.hydrometeor());
    DrawField(ui, field);
    ImGui::PopID();
  }
  DrawParticleSizes(ui);
  ImGui::EndDisabled();
  Quiet("Radius, albedo and phase function of each field are under Every setting (X).");
}

}  // namespace thunderhead::desktop
