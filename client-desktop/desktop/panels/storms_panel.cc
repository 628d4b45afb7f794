// The list of every storm that the server found.
#include <imgui.h>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"

namespace thunderhead::desktop {
namespace {

void DrawStorm(Ui& ui, const v1::StormSummary& storm) {
  const bool shown = storm.id() == ui.state.scene.storm_id();
  const float height = 2.0F * ImGui::GetTextLineHeight() + 10.0F * ui.scale;
  const ImVec2 at = ImGui::GetCursorPos();
  if (ImGui::Selectable("##storm", shown, 0, {0.0F, height})) {
    ui.ShowStorm(storm.id());
  }
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    ImGui::SetTooltip("%s\n%s", storm.title().c_str(), storm.id().c_str());
  const ImVec2 below = ImGui::GetCursorPos();
  ImGui::SetCursorPos({at.x + 8.0F * ui.scale, at.y + 3.0F * ui.scale});
  const float room = ImGui::GetContentRegionAvail().x - 8.0F * ui.scale;
  ImGui::TextUnformatted(Shortened(storm.title(), room).c_str());
  ImGui::SetCursorPos(
      {at.x + 8.0F * ui.scale, at.y + 5.0F * ui.scale + ImGui::GetTextLineHeight()});
  const std::string times =
      absl::StrCat(" · ", storm.time_count(), storm.time_count() == 1 ? " time" : " times");
  QuietLine(Shortened(storm.id(), room - ImGui::CalcTextSize(times.c_str()).x) + times);
  ImGui::SetCursorPos(below);
}

}  // namespace

void StormsPanel(Ui& ui) {
  if (ui.storms.storms.storms().empty())
    Quiet("The server has no storms, or has not listed them yet.");
  ImGui::BeginDisabled(!ui.state.Steers());
  for (const v1::StormSummary& storm : ui.storms.storms.storms()) {
    ImGui::PushID(storm.id().c_str());
    DrawStorm(ui, storm);
    ImGui::PopID();
  }
  ImGui::EndDisabled();
  const auto& server = ui.storms.server;
  if (!server.version().empty()) {
    Quiet(absl::StrCat("Server ", server.version(), " on ", server.gl_renderer()));
  }
}

}  // namespace thunderhead::desktop
