// Counts the user's input events that the window has handled, and the drawings since the last
// event. Tests send real input. They read these counts in the status file to learn when the input
// was handled and its effect drawn.
#pragma once

#include <SDL.h>

#include <cstdint>

namespace thunderhead::desktop {

struct InputTally {
  // Counts an event. Events that are not input change nothing.
  void Take(const SDL_Event& event);

  std::int64_t keys = 0;     // keys released, except Shift, Ctrl, Alt and the like
  std::int64_t buttons = 0;  // number of presses and releases of mouse buttons
  std::int64_t notches = 0;  // number of events of the mouse wheel, usually one a notch
  // Pointer position at its last motion, in the window's units; -1 before the first motion.
  int pointer_x = -1;
  int pointer_y = -1;
  // Number of drawings since the last event of the window, or since texts changed.
  int drawings = 0;
};

}  // namespace thunderhead::desktop
