// The rail of six tools, of which one can be open at a time. Each has a key. This file also draws
// the panel of the open tool.
#include <imgui.h>

#include <algorithm>
#include <array>

#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"

namespace thunderhead::desktop {
namespace {

struct ToolText {
  Tool tool;
  const char* label;
  const char* title;
  const char* key;
  void (*draw)(Ui&);
};

constexpr std::array<ToolText, 6> kTools{{
    {Tool::kCamera, "Camera", "Camera", "M", CameraTool},
    {Tool::kTime, "Time", "Time", "T", TimeTool},
    {Tool::kLight, "Light", "Light", "L", LightTool},
    {Tool::kLook, "Look", "Look", "K", LookTool},
    {Tool::kFields, "Fields", "Fields", "F", FieldsTool},
    {Tool::kMarks, "Marks", "Pointer and marks", "D", MarksTool},
}};

}  // namespace

void DrawToolRail(Ui& ui, const Layout& layout) {
  const float button_height = 40.0F * ui.scale;
  const ImGuiStyle& style = ImGui::GetStyle();
  const float padding = 7.0F * ui.scale;
  const float whole =
      kTools.size() * button_height + (kTools.size() - 1) * style.ItemSpacing.y + 2.0F * padding;
  // The rail may reach down to the window's lower edge, because the time line is next to it, not
  // below it. If even that height is too small, the wheel scrolls the rail.
  const float height = std::min(whole, layout.window.y - layout.margin - layout.top());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {padding, padding});
  if (BeginPanel("tool rail", {layout.margin, layout.top()}, {layout.rail_width, height},
                 ImGuiWindowFlags_NoScrollbar)) {
    ImGui::PushFont(SmallFont());
    for (const ToolText& each : kTools) {
      const bool open = ui.choices.tool == each.tool;
      ImGui::PushStyleColor(
          ImGuiCol_Button, open ? ImVec4(1.0F, 1.0F, 1.0F, 0.17F) : ImVec4(0.0F, 0.0F, 0.0F, 0.0F));
      ImGui::PushStyleColor(ImGuiCol_Text, open ? kAccent : style.Colors[ImGuiCol_Text]);
      if (ImGui::Button(each.label, {-1.0F, button_height})) ui.choices.Toggle(each.tool);
      ImGui::PopStyleColor(2);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s (%s)", each.title, each.key);
    }
    ImGui::PopFont();
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

void DrawTool(Ui& ui, const Layout& layout) {
  for (const ToolText& each : kTools) {
    if (each.tool != ui.choices.tool) continue;
    const ImVec2 place(2.0F * layout.margin + layout.rail_width, layout.top());
    ImGui::SetNextWindowSizeConstraints({layout.tool_width, 0.0F},
                                        {layout.tool_width, layout.bottom() - layout.top()});
    // The height of 0 makes the panel as high as its controls.
    if (BeginPanel(each.title, place, {layout.tool_width, 0.0F})) {
      if (ui.choices.focuses_panel) GiveKeysToPanel();
      Title(each.title, each.key);
      ImGui::Spacing();
      each.draw(ui);
    }
    ImGui::End();
  }
}

}  // namespace thunderhead::desktop
