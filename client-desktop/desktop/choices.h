// The open panels and the choices of the window. None of them is part of the scene.
#pragma once

#include <string>

namespace thunderhead::desktop {

enum class Tool { kNone, kCamera, kTime, kLight, kLook, kFields, kMarks };
enum class Panel { kNone, kStorms, kPeople, kReadout, kDrawer, kHelp };
enum class Hand { kCamera, kPen, kPointer };

struct Choices {
  Tool tool = Tool::kNone;
  Panel panel = Panel::kNone;
  Hand hand = Hand::kCamera;
  bool focuses_panel = false;  // the panel gets the keyboard in the next frame
  std::string query;           // search text of the drawer
  std::string name;            // typed but not sent yet

  // Opens a tool in place of the open tool, or closes it. Closing the marks tool also puts the pen
  // down.
  void Toggle(Tool chosen) {
    tool = tool == chosen ? Tool::kNone : chosen;
    if (tool != Tool::kMarks) hand = Hand::kCamera;
  }
  void Toggle(Panel chosen) { panel = panel == chosen ? Panel::kNone : chosen; }
  // Closes the uppermost panel or tool, in the web page's order. Returns false if there was nothing
  // to close.
  bool Close();
};

}  // namespace thunderhead::desktop
