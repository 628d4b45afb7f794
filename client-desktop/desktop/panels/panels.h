// The panels over the picture; each has its own file. A panel is drawn at its position in Layout,
// and shows and changes the Ui.
#pragma once

#include <imgui.h>

#include "desktop/ui.h"

namespace thunderhead::desktop {

// Positions and sizes in the window's units.
struct Layout {
  static constexpr float kPanelPerTool = 400.0F / 330.0F;

  float margin = 0.0F;
  float bar_height = 0.0F;
  float rail_width = 0.0F;
  float line_height = 0.0F;  // height of the time line
  float tool_width = 0.0F;
  ImVec2 window;

  static Layout Of(float width, float height, float scale);
  float panel_width() const { return kPanelPerTool * tool_width; }  // width of a panel at the right
  float tool_right() const { return 2.0F * margin + rail_width + tool_width; }
  // The panels lie below the bar and above the time line.
  float top() const { return 2.0F * margin + bar_height; }
  float bottom() const { return window.y - 2.0F * margin - line_height; }
};

void DrawTopBar(Ui& ui, const Layout& layout);
void DrawToolRail(Ui& ui, const Layout& layout);
// Draws the open tool.
void DrawTool(Ui& ui, const Layout& layout);
void DrawTimeLine(Ui& ui, const Layout& layout);
// Draws the person in control, and requests for control. If the user has left the session's view
// for a view of their own ("You look around"), it also draws the button that returns to the
// session's view. If the session no longer exists, it draws only the button that opens a new one.
void DrawSessionBar(Ui& ui, const Layout& layout);
// Draws the accuracy of the picture, failures and the newest notice.
void DrawNotices(Ui& ui, const Layout& layout);
// Draws the open panel at the right.
void DrawPanel(Ui& ui, const Layout& layout);

// These functions draw the contents of tools and panels.
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
