// A window with OpenGL and Dear ImGui, whose texts and controls scale with its monitor.
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
  // Scale factor of texts and controls; 0: the window chooses it for the monitor.
  double scale = 0.0;
};

// Returns the scale factor of texts and controls in the window's units, a multiple of 0.25. `dpi`
// is the monitor's number of physical pixels per inch. The factor is 1 if `dpi` is implausible, as
// is common for projectors. It is also 1 if a unit has several pixels, as under Wayland, because
// the desktop has then already scaled the window.
float ScaleOfMonitor(float dpi, float pixels_per_unit);

class Window {
 public:
  // Opens a window. The error says why SDL or OpenGL could not be started.
  static absl::StatusOr<std::unique_ptr<Window>> Open(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Passes an event to the interface.
  void Take(const SDL_Event& event);
  // Calls `build`, which makes the interface by ImGui calls, then draws the interface and shows it.
  void Draw(const std::function<void()>& build);
  // Returns true if a panel of the last drawing covers this point, given in the window's units, or
  // if a list of choices is open. ImGui itself reports this only after the next drawing, which is
  // too late for a press that follows a quick motion.
  bool IsOverPanel(float x, float y) const;
  void ToggleFullScreen();
  bool full_screen() const;
  bool minimized() const;
  // Returns the scale factor of texts and controls, in the window's units.
  float scale() const { return scale_; }
  // These sizes are in physical pixels.
  int width_px() const;
  int height_px() const;
  // These sizes are in the units of the window's events.
  float width() const;
  float height() const;

 private:
  Window(const WindowOptions& options, SDL_Window* window, SDL_GLContext context);
  void Rescale();

  const WindowOptions options_;
  SDL_Window* const window_;
  const SDL_GLContext context_;
  bool opened_full_screen_;  // true until the window first leaves full screen
  float scale_ = 0.0F;
  float pixels_per_unit_ = 0.0F;
};

}  // namespace thunderhead::desktop
