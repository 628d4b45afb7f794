// Counts the user's input that the window has handled, and the drawings since then. Tests send real
// input, and read in the status file when the window has handled and drawn it.
#pragma once

#include <SDL.h>

#include <cstdint>

namespace thunderhead::desktop {

struct InputTally {
  // Counts an event. Events that are not input change nothing.
  void Take(const SDL_Event& event);

  std::int64_t keys = 0;     // keys released, except Shift, Ctrl, Alt and the like
  std::int64_t buttons = 0;  // mouse buttons pressed or released
  std::int64_t notches = 0;  // notches of the wheel
  int pointer_x = -1;        // position at the last motion, in the window's units
  int pointer_y = -1;
  int drawings = 0;  // number since the last event of the window, or since texts changed
};

}  // namespace thunderhead::desktop
