// Mouse, touch pad and touch over the picture, as camera motions: a drag turns; with the right or
// middle button, shift or two fingers it moves; the wheel or a pinch comes nearer. With a tool in
// the hand the left button uses that. Reads SDL's events and knows no window.
#pragma once

#include <SDL.h>

#include <functional>
#include <optional>

#include "thunderhead_client/pose.h"

namespace thunderhead::desktop {

struct ScreenPoint {
  float x = 0.0F;  // from the left, in the window's units
  float y = 0.0F;  // from the top
};

// Presses, moves and releases of a tool in the hand.
struct ToolSteps {
  std::function<void(ScreenPoint)> press;
  std::function<void(ScreenPoint)> drag;
  std::function<void(bool cancelled)> release;
  std::function<void(std::optional<ScreenPoint>)> hover;  // nothing: the pointer left
};

class PointerInput {
 public:
  using Motion = std::function<client::Pose(const client::Pose&)>;
  using Move = std::function<void(const Motion&)>;

  explicit PointerInput(Move move) : move_(std::move(move)) {}

  // The window's size in the units of its events.
  void SetSize(float width, float height) { size_ = {width, height}; }
  // The tool in the hand; null for the camera.
  void SetTool(const ToolSteps* tool);
  // True if the event was one over the picture. `over_picture` is false over a panel, where only
  // what has begun goes on.
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
  int held_button_ = 0;  // that began over the picture
  bool draws_ = false;   // with the tool
  bool pans_ = false;
  bool hovers_ = false;
  int fingers_ = 0;
  bool two_fingers_ = false;               // until all have left
  std::optional<ScreenPoint> gesture_at_;  // of 0 to 1
};

}  // namespace thunderhead::desktop
