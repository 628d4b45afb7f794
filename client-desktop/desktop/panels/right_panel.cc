// Draws the open panel at the right: storms, people, statistics of the pictures, every setting, or
// the keys.
#include <imgui.h>

#include <array>

#include "desktop/controls.h"
#include "desktop/keyboard.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"

namespace thunderhead::desktop {
namespace {

struct PanelText {
  Panel panel;
  const char* title;
  const char* key;
  void (*draw)(Ui&);
  bool whole;  // true if the panel has the whole free height
};

constexpr std::array<PanelText, 5> kPanels{{
    {Panel::kStorms, "Storms", "O", StormsPanel, false},
    {Panel::kPeople, "People", "H", PeoplePanel, false},
    {Panel::kReadout, "Figures", "I", ReadoutPanel, false},
    {Panel::kDrawer, "Every setting", "X", DrawerPanel, true},
    {Panel::kHelp, "Keys", "?", HelpPanel, false},
}};

}  // namespace

void DrawPanel(Ui& ui, const Layout& layout) {
  for (const PanelText& each : kPanels) {
    if (each.panel != ui.choices.panel) continue;
    const float width = layout.panel_width();
    const float most = layout.bottom() - layout.top();
    ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, most});
    const ImVec2 place(layout.window.x - layout.margin - width, layout.top());
    if (BeginPanel(each.title, place, {width, each.whole ? most : 0.0F})) {
      if (ui.choices.focuses_panel) GiveKeysToPanel();
      Title(each.title, each.key);
      ImGui::Spacing();
      each.draw(ui);
    }
    ImGui::End();
  }
}

void HelpPanel(Ui& /*ui*/) {
  if (!ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) return;
  ImGui::TableSetupColumn("keys");
  ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch);
  for (const auto& [keys, meaning] : kKeyTexts) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushFont(SmallFont());
    ImGui::TextUnformatted(keys);
    ImGui::TableNextColumn();
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextDisabled("%s", meaning);
    ImGui::PopTextWrapPos();
    ImGui::PopFont();
  }
  ImGui::EndTable();
}

}  // namespace thunderhead::desktop
