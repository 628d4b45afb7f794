#include "desktop/keyboard.h"

#include <optional>

namespace thunderhead::desktop {
namespace {

using client::Pose;

constexpr double kTurn_deg = 3.0;
// Moves by this many hundredths of the picture.
constexpr double kPan_px = 5.0;
constexpr client::PictureSize kPicture{100.0, 100.0};
constexpr double kZoomFactor = 0.88;

// An arrow key turns an orbit camera around the storm or a spotter's head, and moves a map.
Pose Look(const Pose& pose, int right, int down) {
  if (std::holds_alternative<client::TopDownPose>(pose)) {
    return client::Pan(pose, -right * kPan_px, -down * kPan_px, kPicture);
  }
  return client::Turn(pose, right * kTurn_deg, -down * kTurn_deg);
}

std::optional<std::pair<int, int>> ArrowOf(SDL_Keycode key) {
  switch (key) {
    case SDLK_LEFT:
      return std::pair{-1, 0};
    case SDLK_RIGHT:
      return std::pair{1, 0};
    case SDLK_UP:
      return std::pair{0, -1};
    case SDLK_DOWN:
      return std::pair{0, 1};
    default:
      return {};
  }
}

std::optional<Tool> ToolOf(SDL_Keycode key) {
  switch (key) {
    case SDLK_m:
    case SDLK_1:
      return Tool::kCamera;
    case SDLK_t:
    case SDLK_2:
      return Tool::kTime;
    case SDLK_l:
    case SDLK_3:
      return Tool::kLight;
    case SDLK_k:
    case SDLK_4:
      return Tool::kLook;
    case SDLK_f:
    case SDLK_5:
      return Tool::kFields;
    case SDLK_d:
    case SDLK_7:
      return Tool::kMarks;
    default:
      return {};
  }
}

std::optional<Panel> PanelOf(SDL_Keycode key, bool shift) {
  if (key == SDLK_QUESTION || (key == SDLK_SLASH && shift)) return Panel::kHelp;
  switch (key) {
    case SDLK_x:
      return Panel::kDrawer;
    case SDLK_s:
      return Panel::kStorms;
    case SDLK_h:
      return Panel::kPeople;
    case SDLK_i:
      return Panel::kReadout;
    default:
      return {};
  }
}

bool Edits(SDL_Keycode key, bool shift, const KeyActions& actions) {
  if (key == SDLK_z && !shift) {
    actions.undo();
  } else if (key == SDLK_y || key == SDLK_z) {
    actions.redo();
  } else {
    return false;
  }
  return true;
}

bool Zooms(const SDL_KeyboardEvent& event, const KeyActions& actions) {
  switch (event.keysym.sym) {
    case SDLK_PLUS:
    case SDLK_EQUALS:
    case SDLK_KP_PLUS:
      actions.move([](const Pose& pose) { return client::Zoom(pose, kZoomFactor); });
      return true;
    case SDLK_MINUS:
    case SDLK_UNDERSCORE:
    case SDLK_KP_MINUS:
      actions.move([](const Pose& pose) { return client::Zoom(pose, 1.0 / kZoomFactor); });
      return true;
    default:
      return false;
  }
}

bool Goes(SDL_Keycode key, bool controls, const KeyActions& actions) {
  switch (key) {
    case SDLK_HOME:
      actions.home();
      return true;
    case SDLK_SPACE:
      if (!controls) actions.toggle_play();
      return !controls;
    case SDLK_COMMA:
      actions.step_time(-1);
      return true;
    case SDLK_PERIOD:
      actions.step_time(1);
      return true;
    case SDLK_w:
    case SDLK_F11:
      actions.full_screen();
      return true;
    case SDLK_TAB:
      if (!controls) actions.focus_panel();
      return !controls;
    default:
      return false;
  }
}

}  // namespace

bool TakeKey(const SDL_KeyboardEvent& event, const KeyFocus& focus, const KeyActions& actions) {
  const SDL_Keycode key = event.keysym.sym;
  const bool shift = (event.keysym.mod & KMOD_SHIFT) != 0;
  if (focus.text) return false;
  if (key == SDLK_ESCAPE) {
    actions.escape();
    return true;
  }
  if ((event.keysym.mod & KMOD_CTRL) != 0) return Edits(key, shift, actions);
  if ((event.keysym.mod & (KMOD_ALT | KMOD_GUI)) != 0) return false;
  if (const auto arrow = ArrowOf(key)) {
    if (focus.controls) return false;
    const auto [right, down] = *arrow;
    actions.move([=](const Pose& pose) {
      return shift ? client::Pan(pose, right * kPan_px, down * kPan_px, kPicture)
                   : Look(pose, right, down);
    });
    return true;
  }
  if (Zooms(event, actions) || Goes(key, focus.controls, actions)) return true;
  if (const auto tool = ToolOf(key)) {
    actions.toggle_tool(*tool);
    return true;
  }
  const auto panel = PanelOf(key, shift);
  if (panel) actions.toggle_panel(*panel);
  return panel.has_value();
}

}  // namespace thunderhead::desktop
