// The tool "Marks": the pen and the pointer. All people in the session see what they draw and point
// at.
#include <imgui.h>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"

namespace thunderhead::desktop {

void MarksTool(Ui& ui) {
  const bool may_mark = ui.state.MayMark();
  ImGui::BeginDisabled(!may_mark);
  int hand = static_cast<int>(ui.choices.hand);
  if (Segments("hand", {"Camera", "Pen", "Pointer"}, hand)) {
    ui.choices.hand = static_cast<Hand>(hand);
  }
  switch (ui.choices.hand) {
    case Hand::kCamera:
      Quiet("The left button turns the camera.");
      break;
    case Hand::kPen:
      Quiet(
          "Draw with the left button. Lines lie on the storm or the ground, and stay there when "
          "the camera turns.");
      break;
    case Hand::kPointer:
      Quiet("Everyone sees where you point.");
      break;
  }
  ImGui::Spacing();
  const int count = ui.state.marks.marks_size();
  ImGui::BeginDisabled(count == 0);
  if (ImGui::Button(ui.state.Presents() ? "Erase all marks" : "Erase my marks")) {
    ui.session.EraseMarks();
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  if (!may_mark) Quiet("The presenter has not allowed viewers to point and draw.");
}

}  // namespace thunderhead::desktop
