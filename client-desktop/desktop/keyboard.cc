#include "desktop/keyboard.h"

#include <optional>
#include <string_view>

namespace thunderhead::desktop {
namespace {

using client::Pose;

constexpr double kTurn_deg = 3.0;
// Pan distance of one key press in pixels of kPicture, which is 100 x 100 pixels: 5 % of the
// picture.
constexpr double kPan_px = 5.0;
constexpr client::PictureSize kPicture{100.0, 100.0};
constexpr double kZoomFactor = 0.88;

// Turns an orbit camera around the storm or a spotter's head by an arrow key, or moves a top-down
// camera.
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

std::optional<Tool> ToolOfLetter(SDL_Keycode key) {
  switch (key) {
    case SDLK_m:
      return Tool::kCamera;
    case SDLK_t:
      return Tool::kTime;
    case SDLK_l:
      return Tool::kLight;
    case SDLK_k:
      return Tool::kLook;
    case SDLK_f:
      return Tool::kFields;
    case SDLK_d:
      return Tool::kMarks;
    default:
      return {};
  }
}

std::optional<Tool> ToolOfDigit(int digit) {
  switch (digit) {
    case 1:
      return Tool::kCamera;
    case 2:
      return Tool::kTime;
    case 3:
      return Tool::kLight;
    case 4:
      return Tool::kLook;
    case 5:
      return Tool::kFields;
    case 7:
      return Tool::kMarks;
    default:
      return {};
  }
}

// Returns the digit at a key's position in the row above the letters; 0 for other keys. A French
// keyboard has other characters there without Shift. Returns 0 for a character that TakeText uses,
// so that it keeps its meaning.
int DigitOf(const SDL_Keysym& key) {
  constexpr std::string_view kUsed = "+=-_,.?";
  const bool used = key.sym > 0 && key.sym < 0x80 &&
                    kUsed.find(static_cast<char>(key.sym)) != std::string_view::npos;
  if (used || key.scancode < SDL_SCANCODE_1 || key.scancode > SDL_SCANCODE_9) return 0;
  return key.scancode - SDL_SCANCODE_1 + 1;
}

std::optional<Panel> PanelOf(SDL_Keycode key) {
  switch (key) {
    case SDLK_x:
      return Panel::kDrawer;
    case SDLK_o:
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

bool Goes(SDL_Keycode key, bool controls, const KeyActions& actions) {
  switch (key) {
    case SDLK_HOME:
      actions.home();
      return true;
    case SDLK_SPACE:
      if (!controls) actions.toggle_play();
      return !controls;
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
  if ((event.keysym.mod & KMOD_ALT) != 0) return false;
  if ((event.keysym.mod & (KMOD_CTRL | KMOD_GUI)) != 0) return Edits(key, shift, actions);
  if (const auto arrow = ArrowOf(key)) {
    if (focus.controls) return false;
    actions.move([shift, right = arrow->first, down = arrow->second](const Pose& pose) {
      return shift ? client::Pan(pose, right * kPan_px, down * kPan_px, kPicture)
                   : Look(pose, right, down);
    });
    return true;
  }
  if (Goes(key, focus.controls, actions)) return true;
  const auto letter = ToolOfLetter(key);
  // With Shift, the digit arrives as text instead, if the layout has a digit there.
  const auto tool = letter || shift ? letter : ToolOfDigit(DigitOf(event.keysym));
  if (tool) {
    actions.toggle_tool(*tool);
    return true;
  }
  const auto panel = PanelOf(key);
  if (panel) actions.toggle_panel(*panel);
  return panel.has_value();
}

bool TakeText(std::string_view text, Uint16 modifiers, const KeyFocus& focus,
              const KeyActions& actions) {
  const bool shift = (modifiers & KMOD_SHIFT) != 0;
  if (focus.text || text.size() != 1) return false;
  if ((modifiers & (KMOD_CTRL | KMOD_LALT | KMOD_GUI)) != 0) return false;
  switch (text.front()) {
    case '+':
    case '=':
      actions.move([](const Pose& pose) { return client::Zoom(pose, kZoomFactor); });
      return true;
    case '-':
    case '_':
      actions.move([](const Pose& pose) { return client::Zoom(pose, 1.0 / kZoomFactor); });
      return true;
    case ',':
      actions.step_time(-1);
      return true;
    case '.':
      actions.step_time(1);
      return true;
    case '?':
      actions.toggle_panel(Panel::kHelp);
      return true;
    default:
      break;
  }
  const auto tool = shift ? ToolOfDigit(text.front() - '0') : std::nullopt;
  if (tool) actions.toggle_tool(*tool);
  return tool.has_value();
}

}  // namespace thunderhead::desktop
