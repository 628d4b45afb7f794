// A window with OpenGL and Dear ImGui: opens, scales with its monitor, shows a frame of the
// interface.
#pragma once

#include <SDL.h>

#include <functional>
#include <memory>

#include "absl/status/statusor.h"

namespace thunderhead::desktop {

struct WindowOptions {
  int width = 1280;
  int height = 800;
  bool full_screen = false;
  bool hides_cursor = false;
  double scale = 0.0;  // of texts and controls; 0: as the monitor asks
};

// Of texts and controls, in the window's units. Monitors report sizes that do not make sense,
// projectors above all: 1 then. `dpi` counts the monitor's pixels: where a unit is several of them,
// as under Wayland, the desktop has scaled the window already, and it is 1 as well.
float ScaleOfMonitor(float dpi, float pixels_per_unit);

class Window {
 public:
  // An error says what SDL or OpenGL lacks.
  static absl::StatusOr<std::unique_ptr<Window>> Open(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Passes an event to the interface.
  void Take(const SDL_Event& event);
  // Draws the interface that `build` makes, and shows it.
  void Draw(const std::function<void()>& build);
  // True if a panel of the last frame is there, in the window's units. The interface itself knows
  // only once it is drawn again, too late for a press that follows a quick motion.
  bool IsOverPanel(float x, float y) const;
  void ToggleFullScreen();
  bool full_screen() const;
  bool minimized() const;
  // Of texts and controls, in the window's units.
  float scale() const { return scale_; }
  // In physical pixels.
  int width_px() const;
  int height_px() const;
  // Sizes of the window in the units of its events.
  float width() const;
  float height() const;

 private:
  Window(const WindowOptions& options, SDL_Window* window, SDL_GLContext context);
  void Rescale();

  const WindowOptions options_;
  SDL_Window* const window_;
  const SDL_GLContext context_;
  bool opened_full_screen_;  // and has not left it
  float scale_ = 0.0F;
  float pixels_per_unit_ = 0.0F;
};

}  // namespace thunderhead::desktop
