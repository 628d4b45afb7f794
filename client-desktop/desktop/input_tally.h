// Counts the user's input that the window has taken, and the drawings since then. Tests send real
// input and read in the status file when the window has handled and drawn it.
#pragma once

#include <SDL.h>

#include <cstdint>

namespace thunderhead::desktop {

struct InputTally {
  // An event that is no input changes nothing.
  void Take(const SDL_Event& event);

  std::int64_t keys = 0;     // released, without Shift, Ctrl, Alt and the like
  std::int64_t buttons = 0;  // of the mouse, pressed or released
  std::int64_t notches = 0;  // of the wheel
  int pointer_x = -1;        // at its last motion, in the window's units
  int pointer_y = -1;
  int drawings = 0;  // since the last event of the window, or since texts changed
};

}  // namespace thunderhead::desktop
