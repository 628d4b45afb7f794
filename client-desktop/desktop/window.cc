#include "desktop/window.h"

#include <GL/gl.h>
#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "desktop/style.h"

namespace thunderhead::desktop {
namespace {

absl::Status SdlError(const char* what) {
  return absl::UnavailableError(
      absl::StrCat(what, ": ", SDL_GetError(),
                   "; it needs a display (DISPLAY or WAYLAND_DISPLAY) and OpenGL 3"));
}

// Returns the monitor's dots per inch; 0 if the number is unknown.
float DpiOfMonitor(SDL_Window* window) {
  float dpi = 0.0F;
  const int display = SDL_GetWindowDisplayIndex(window);
  if (display < 0 || SDL_GetDisplayDPI(display, nullptr, &dpi, nullptr) != 0) return 0.0F;
  return dpi;
}

}  // namespace

float ScaleOfMonitor(float dpi, float pixels_per_unit) {
  constexpr float kUsual_dpi = 96.0F;
  constexpr float kStep = 0.25F;
  if (pixels_per_unit > 1.0F || !(dpi >= kUsual_dpi && dpi <= 4.0F * kUsual_dpi)) return 1.0F;
  return std::round(dpi / kUsual_dpi / kStep) * kStep;
}

absl::StatusOr<std::unique_ptr<Window>> Window::Open(const WindowOptions& options) {
  SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, options.hides_cursor ? "0" : "1");
  // SDL must not ask the compositor to let the window bypass it. Some compositors would then leave
  // the window without a picture.
  SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return SdlError("cannot start the display");
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 2);
  SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 0);
  Uint32 flags = SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI;
  if (options.full_screen) flags |= SDL_WINDOW_FULLSCREEN_DESKTOP;
  // A full-screen window is opened at the display's size here. Without a window manager, as on a
  // kiosk, no other program would enlarge the window.
  SDL_Rect place{SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, options.width, options.height};
  if (options.full_screen) SDL_GetDisplayBounds(0, &place);
  SDL_Window* const window =
      SDL_CreateWindow("Thunderhead", place.x, place.y, place.w, place.h, flags);
  if (window == nullptr) return SdlError("cannot open a window");
  const SDL_GLContext context = SDL_GL_CreateContext(window);
  if (context == nullptr) {
    const absl::Status status = SdlError("cannot start OpenGL");
    SDL_DestroyWindow(window);
    return status;
  }
  SDL_GL_SetSwapInterval(1);
  return std::unique_ptr<Window>(new Window(options, window, context));
}

Window::Window(const WindowOptions& options, SDL_Window* window, SDL_GLContext context)
    : options_(options),
      window_(window),
      context_(context),
      opened_full_screen_(options.full_screen) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  if (options.hides_cursor) ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
  ImGui_ImplSDL2_InitForOpenGL(window_, context_);
  ImGui_ImplOpenGL3_Init("#version 150");
  SDL_SetWindowMinimumSize(window_, 320, 240);
  if (options.hides_cursor) {
    SDL_ShowCursor(SDL_DISABLE);
    SDL_DisableScreenSaver();
  }
  Rescale();
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplSDL2_Shutdown();
  ImGui::DestroyContext();
  SDL_GL_DeleteContext(context_);
  SDL_DestroyWindow(window_);
  SDL_Quit();
}

void Window::Rescale() {
  const float pixels_per_unit =
      static_cast<float>(width_px()) / std::max(1.0F, static_cast<float>(width()));
  const float scale = options_.scale > 0.0 ? static_cast<float>(options_.scale)
                                           : ScaleOfMonitor(DpiOfMonitor(window_), pixels_per_unit);
  if (scale == scale_ && pixels_per_unit == pixels_per_unit_) return;
  scale_ = scale;
  pixels_per_unit_ = pixels_per_unit;
  ApplyStyle(scale_, pixels_per_unit_);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::Take(const SDL_Event& event) {
  ImGui_ImplSDL2_ProcessEvent(&event);
  if (event.type != SDL_WINDOWEVENT) return;
  // The window may have moved to another monitor, or its monitor's scale may have changed.
  if (event.window.event == SDL_WINDOWEVENT_DISPLAY_CHANGED ||
      event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) {
    Rescale();
  }
}

void Window::Draw(const std::function<void()>& build) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  ImGui::NewFrame();
  build();
  ImGui::Render();
  glViewport(0, 0, width_px(), height_px());
  constexpr float kDark = 0.035F;
  glClearColor(kDark, kDark, kDark, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  SDL_GL_SwapWindow(window_);
}

bool Window::IsOverPanel(float x, float y) const {
  const ImGuiContext& context = *ImGui::GetCurrentContext();
  if (context.OpenPopupStack.Size > 0) return true;
  for (const ImGuiWindow* const panel : context.Windows) {
    const bool takes =
        panel->WasActive && !panel->Hidden && (panel->Flags & ImGuiWindowFlags_NoMouseInputs) == 0;
    if (takes && panel->OuterRectClipped.Contains({x, y})) return true;
  }
  return false;
}

bool Window::full_screen() const {
  return (SDL_GetWindowFlags(window_) & SDL_WINDOW_FULLSCREEN_DESKTOP) != 0;
}

void Window::ToggleFullScreen() {
  const bool leaves = full_screen();
  SDL_SetWindowFullscreen(window_, leaves ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
  // The window was opened with the display's size, so it needs its normal size now.
  if (leaves && std::exchange(opened_full_screen_, false)) {
    SDL_SetWindowSize(window_, options_.width, options_.height);
  }
}

bool Window::minimized() const {
  // SDL_WINDOW_HIDDEN is not checked, because it is also set until the display has mapped the
  // window.
  return (SDL_GetWindowFlags(window_) & SDL_WINDOW_MINIMIZED) != 0;
}

int Window::width_px() const {
  int width = 0;
  SDL_GL_GetDrawableSize(window_, &width, nullptr);
  return width;
}

int Window::height_px() const {
  int height = 0;
  SDL_GL_GetDrawableSize(window_, nullptr, &height);
  return height;
}

float Window::width() const {
  int width = 0;
  SDL_GetWindowSize(window_, &width, nullptr);
  return static_cast<float>(width);
}

float Window::height() const {
  int height = 0;
  SDL_GetWindowSize(window_, nullptr, &height);
  return static_cast<float>(height);
}

}  // namespace thunderhead::desktop
