// The panels over the picture, one file each. Each draws itself where the layout says, and acts
// upon the Ui.
#pragma once

#include <imgui.h>

#include "desktop/ui.h"

namespace thunderhead::desktop {

// Measures in the window's units.
struct Layout {
  static constexpr float kPanelPerTool = 400.0F / 330.0F;

  float margin = 0.0F;
  float bar_height = 0.0F;
  float rail_width = 0.0F;
  float line_height = 0.0F;  // of the time line
  float tool_width = 0.0F;
  ImVec2 window;

  static Layout Of(float width, float height, float scale);
  float panel_width() const { return kPanelPerTool * tool_width; }  // of one at the right
  float tool_right() const { return 2.0F * margin + rail_width + tool_width; }
  // Below the bar, above the time line.
  float top() const { return 2.0F * margin + bar_height; }
  float bottom() const { return window.y - 2.0F * margin - line_height; }
};

void DrawTopBar(Ui& ui, const Layout& layout);
void DrawToolRail(Ui& ui, const Layout& layout);
// The tool that is open.
void DrawTool(Ui& ui, const Layout& layout);
void DrawTimeLine(Ui& ui, const Layout& layout);
// Who steers, and the way back from looking around; the accuracy and notices.
void DrawSessionBar(Ui& ui, const Layout& layout);
void DrawNotices(Ui& ui, const Layout& layout);
// The panel at the right that is open.
void DrawPanel(Ui& ui, const Layout& layout);

// The contents of tools and panels.
void CameraTool(Ui& ui);
void TimeTool(Ui& ui);
void LightTool(Ui& ui);
void LookTool(Ui& ui);
void FieldsTool(Ui& ui);
void MarksTool(Ui& ui);
void StormsPanel(Ui& ui);
void PeoplePanel(Ui& ui);
void ReadoutPanel(Ui& ui);
void DrawerPanel(Ui& ui);
void HelpPanel(Ui& ui);

}  // namespace thunderhead::desktop
