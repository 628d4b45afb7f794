// What this window shows: its open tool and panel, and its user's choices. None of this is part of
// the scene.
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
  bool focuses_panel = false;  // the open panel gets the keyboard focus in the next drawing
  std::string query;           // search text of the panel of every setting
  std::string name;            // person's name that was typed but not sent yet

  // Opens a tool in place of the open tool, or closes it. If the marks tool is not open afterwards,
  // also puts the pen or pointer down.
  void Toggle(Tool chosen) {
    tool = tool == chosen ? Tool::kNone : chosen;
    if (tool != Tool::kMarks) hand = Hand::kCamera;
  }
  void Toggle(Panel chosen) { panel = panel == chosen ? Panel::kNone : chosen; }
  // Closes the open panel, puts down the pen or pointer, or closes the open tool, in the same order
  // as the web page. Returns false if there was nothing to close.
  bool Close();
};

}  // namespace thunderhead::desktop
