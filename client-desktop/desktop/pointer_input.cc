#include "desktop/pointer_input.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::desktop {
namespace {

// One notch of a common wheel changes the distance by 14 %, as on the page.
constexpr double kZoomPerNotch = 0.13;
// Two fingers that move apart by the window's diagonal divide the camera's distance by about five.
constexpr double kZoomPerPinch = 1.6;

ScreenPoint PointOf(int x, int y) { return {static_cast<float>(x), static_cast<float>(y)}; }

}  // namespace

void PointerInput::SetTool(const ToolSteps* tool) {
  if (tool == tool_) return;
  if (draws_) EndDrag(true);
  if (hovers_ && tool_ != nullptr) tool_->hover({});
  hovers_ = false;
  tool_ = tool;
}

bool PointerInput::Take(const SDL_Event& event, bool over_picture) {
  switch (event.type) {
    case SDL_MOUSEBUTTONDOWN:
      return over_picture && Press(event.button);
    case SDL_MOUSEBUTTONUP:
      return Release(event.button);
    case SDL_MOUSEMOTION:
      return MoveTo(event.motion, over_picture);
    case SDL_MOUSEWHEEL:
      return over_picture && Wheel(event.wheel);
    case SDL_FINGERDOWN:
      if (++fingers_ > 1) {
        two_fingers_ = true;
        EndDrag(true);
      }
      return false;
    case SDL_FINGERUP:
      fingers_ = std::max(0, fingers_ - 1);
      gesture_at_.reset();
      two_fingers_ = two_fingers_ && fingers_ > 0;
      return false;
    case SDL_MULTIGESTURE:
      return over_picture && Gesture(event.mgesture);
    case SDL_WINDOWEVENT:
      if (event.window.event == SDL_WINDOWEVENT_LEAVE && hovers_ && tool_ != nullptr) {
        hovers_ = false;
        tool_->hover({});
      }
      return false;
    default:
      return false;
  }
}

bool PointerInput::Press(const SDL_MouseButtonEvent& button) {
  if (two_fingers_ || held_button_ != 0) return true;
  const bool shift = (SDL_GetModState() & KMOD_SHIFT) != 0;
  held_button_ = button.button;
  pans_ = button.button != SDL_BUTTON_LEFT || shift;
  draws_ = tool_ != nullptr && !pans_;
  if (draws_) tool_->press(PointOf(button.x, button.y));
  return true;
}

bool PointerInput::Release(const SDL_MouseButtonEvent& button) {
  if (button.button != held_button_) return false;
  EndDrag(false);
  return true;
}

void PointerInput::EndDrag(bool cancelled) {
  if (draws_ && tool_ != nullptr) tool_->release(cancelled);
  held_button_ = 0;
  draws_ = pans_ = false;
}

bool PointerInput::MoveTo(const SDL_MouseMotionEvent& motion, bool over_picture) {
  if (held_button_ == 0) {
    if (tool_ != nullptr && (over_picture || hovers_)) {
      hovers_ = over_picture;
      tool_->hover(over_picture ? std::optional(PointOf(motion.x, motion.y)) : std::nullopt);
    }
    return false;
  }
  if (draws_) {
    tool_->drag(PointOf(motion.x, motion.y));
    return true;
  }
  const double right = motion.xrel;
  const double down = motion.yrel;
  move_([=, pans = pans_, size = size_](const client::Pose& pose) {
    return pans ? client::Pan(pose, right, down, size) : client::Drag(pose, right, down, size);
  });
  return true;
}

// Zooms by the wheel. Touch pads report fractions of a notch.
bool PointerInput::Wheel(const SDL_MouseWheelEvent& wheel) {
  const double notches =
      wheel.preciseY != 0.0F ? static_cast<double>(wheel.preciseY) : static_cast<double>(wheel.y);
  const double up = wheel.direction == SDL_MOUSEWHEEL_FLIPPED ? -notches : notches;
  if (up == 0.0) return true;
  move_(
      [=](const client::Pose& pose) { return client::Zoom(pose, std::exp(-up * kZoomPerNotch)); });
  return true;
}

// Handles two fingers: their midpoint pans, and their distance zooms.
bool PointerInput::Gesture(const SDL_MultiGestureEvent& gesture) {
  if (gesture.numFingers < 2) return false;
  two_fingers_ = true;
  const ScreenPoint at{gesture.x, gesture.y};
  const ScreenPoint before = gesture_at_.value_or(at);
  gesture_at_ = at;
  const double right = (at.x - before.x) * size_.width_px;
  const double down = (at.y - before.y) * size_.height_px;
  const double factor = std::exp(-static_cast<double>(gesture.dDist) * kZoomPerPinch);
  move_([=, size = size_](const client::Pose& pose) {
    return client::Pan(client::Zoom(pose, factor), right, down, size);
  });
  return true;
}

}  // namespace thunderhead::desktop
