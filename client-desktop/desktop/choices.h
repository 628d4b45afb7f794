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

  void Toggle(Tool chosen) { tool = tool == chosen ? Tool::kNone : chosen; }
  void Toggle(Panel chosen) { panel = panel == chosen ? Panel::kNone : chosen; }
};

}  // namespace thunderhead::desktop
