// Converts mouse, touch pad and touch input over the picture to camera motions. A drag turns the
// camera. A drag with the right or middle button, Shift or two fingers moves it. The wheel or a
// pinch zooms. If a tool is active, the left button uses the tool. This code reads SDL's events and
// does not depend on the window.
#pragma once

#include <SDL.h>

#include <functional>
#include <optional>

#include "thunderhead_client/pose.h"

namespace thunderhead::desktop {

struct ScreenPoint {
  float x = 0.0F;  // distance from the window's left edge, in its units
  float y = 0.0F;  // distance from the window's top edge
};

// Callbacks of the active tool for presses, moves and releases.
struct ToolSteps {
  std::function<void(ScreenPoint)> press;
  std::function<void(ScreenPoint)> drag;
  std::function<void(bool cancelled)> release;
  // No point: the pointer has left the picture.
  std::function<void(std::optional<ScreenPoint>)> hover;
};

class PointerInput {
 public:
  using Motion = std::function<client::Pose(const client::Pose&)>;
  using Move = std::function<void(const Motion&)>;

  explicit PointerInput(Move move) : move_(std::move(move)) {}

  // Sets the window's size, in the same units as the positions in its events.
  void SetSize(float width, float height) { size_ = {width, height}; }
  // Sets the active tool; null if the left button moves the camera.
  void SetTool(const ToolSteps* tool);
  // Handles an event. Returns true if the event belonged to the picture. Pass `over_picture` as
  // false if the pointer is over a panel; only a drag that has already begun then continues.
  bool Take(const SDL_Event& event, bool over_picture);
  bool dragging() const { return held_button_ != 0; }

 private:
  bool Press(const SDL_MouseButtonEvent& button);
  bool Release(const SDL_MouseButtonEvent& button);
  bool MoveTo(const SDL_MouseMotionEvent& motion, bool over_picture);
  bool Wheel(const SDL_MouseWheelEvent& wheel);
  bool Gesture(const SDL_MultiGestureEvent& gesture);
  void EndDrag(bool cancelled);

  const Move move_;
  client::PictureSize size_{1.0, 1.0};
  const ToolSteps* tool_ = nullptr;
  // Mouse button of a drag that began over the picture; 0 without such a drag.
  int held_button_ = 0;
  bool draws_ = false;  // true if the drag uses the active tool
  bool pans_ = false;
  bool hovers_ = false;
  int fingers_ = 0;
  bool two_fingers_ = false;  // a two-finger gesture has begun; true until all fingers are lifted
  // Last midpoint of the fingers, as fractions of the window from 0 to 1.
  std::optional<ScreenPoint> gesture_at_;
};

}  // namespace thunderhead::desktop
