// The picture in the window with the pointers and marks of all people over it. Also the tools with
// which this person points and draws.
#pragma once

#include <vector>

#include "desktop/picture_texture.h"
#include "desktop/pointer_input.h"
#include "desktop/ui.h"
#include "thunderhead_client/projection.h"

namespace thunderhead::desktop {

class Stage {
 public:
  explicit Stage(Ui& ui);

  // Draws the picture centred in the window, as large as fits. Then draws the marks and pointers.
  void Draw(const PictureTexture& picture);
  // Returns the active tool; null if the pointer moves the camera.
  const ToolSteps* HandTool() const;

 private:
  struct Box {
    float left = 0.0F;
    float top = 0.0F;
    float width = 1.0F;
    float height = 1.0F;
  };

  void DrawMarks() const;
  void DrawPointers();
  std::optional<v1::Ray> RayAt(ScreenPoint point) const;
  ScreenPoint PlaceAt(const client::PicturePoint& point) const;
  void EndStroke(bool cancelled);

  Ui& ui_;
  Box box_;
  std::vector<ScreenPoint> stroke_;
  ToolSteps pen_;
  ToolSteps pointer_;
};

}  // namespace thunderhead::desktop
