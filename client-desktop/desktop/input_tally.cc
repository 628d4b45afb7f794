#include "desktop/input_tally.h"

namespace thunderhead::desktop {
namespace {

bool IsModifier(const SDL_Keysym& key) {
  return key.scancode >= SDL_SCANCODE_LCTRL && key.scancode <= SDL_SCANCODE_RGUI;
}

}  // namespace

void InputTally::Take(const SDL_Event& event) {
  switch (event.type) {
    case SDL_KEYUP:
      if (!IsModifier(event.key.keysym)) ++keys;
      break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
      ++buttons;
      break;
    case SDL_MOUSEWHEEL:
      ++notches;
      break;
    case SDL_MOUSEMOTION:
      pointer_x = event.motion.x;
      pointer_y = event.motion.y;
      break;
    default:
      break;
  }
}

}  // namespace thunderhead::desktop
