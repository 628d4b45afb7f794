// The open panels and choices of the window: nothing of it is part of the scene.
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
  bool focuses_panel = false;  // the keyboard goes into the panel with the next frame
  std::string query;           // of the drawer
  std::string name;            // typed, not yet sent

  // Opens a tool in place of the one that is open, or closes it. The pen is put down with the
  // marks.
  void Toggle(Tool chosen) {
    tool = tool == chosen ? Tool::kNone : chosen;
    if (tool != Tool::kMarks) hand = Hand::kCamera;
  }
  void Toggle(Panel chosen) { panel = panel == chosen ? Panel::kNone : chosen; }
  // Closes what is uppermost, in the page's order; false if there was nothing to close.
  bool Close();
};

}  // namespace thunderhead::desktop
