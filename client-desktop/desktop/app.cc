#include "desktop/app.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <tuple>
#include <utility>

#include "absl/strings/str_format.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"

namespace thunderhead::desktop {
namespace {

// After an event ImGui needs several drawings until panels have their final sizes and controls are
// highlighted. The window is drawn for at least kSettles and at least kSettlingDraws times, so a
// slow machine also draws often enough.
constexpr std::chrono::milliseconds kSettles{200};
constexpr int kSettlingDraws = 6;
constexpr std::chrono::milliseconds kFrame{16};
// Number of drawings after which ImGui reports the keyboard focus that a press has caused. ImGui
// handles the press in one drawing, and reports the focus only in a later drawing.
constexpr int kFocusDraws = 3;
constexpr std::chrono::milliseconds kResizeSettles{250};

v1::Window WindowOf(const Window& window, bool saves_bytes) {
  v1::Window told;
  told.set_width_px(static_cast<std::uint32_t>(std::max(1, window.width_px())));
  told.set_height_px(static_cast<std::uint32_t>(std::max(1, window.height_px())));
  told.set_hidden(window.minimized());
  told.set_saves_bytes(saves_bytes);
  return told;
}

// Returns the pointer's position in an event. For an event without a position, returns the
// pointer's current position.
ScreenPoint PlaceOf(const SDL_Event& event) {
  int x = 0;
  int y = 0;
  SDL_GetMouseState(&x, &y);
  if (event.type == SDL_MOUSEMOTION) std::tie(x, y) = std::pair(event.motion.x, event.motion.y);
  if (event.type == SDL_MOUSEBUTTONDOWN) std::tie(x, y) = std::pair(event.button.x, event.button.y);
  return {static_cast<float>(x), static_cast<float>(y)};
}

bool Differs(const v1::Window& a, const v1::Window& b) {
  return a.width_px() != b.width_px() || a.height_px() != b.height_px() || a.hidden() != b.hidden();
}

// Returns the keyboard focus after the last drawing.
KeyFocus FocusNow() {
  const ImGuiIO& io = ImGui::GetIO();
  return {io.WantTextInput, io.WantCaptureKeyboard && (io.NavVisible || ImGui::IsAnyItemActive())};
}

// Returns true for an event after which another control, or none, may have the keyboard.
bool MovesFocus(const SDL_Event& event) {
  if (event.type == SDL_MOUSEBUTTONDOWN || event.type == SDL_MOUSEBUTTONUP) return true;
  if (event.type != SDL_KEYDOWN) return false;
  const SDL_Keycode key = event.key.keysym.sym;
  return key == SDLK_TAB || key == SDLK_RETURN || key == SDLK_KP_ENTER || key == SDLK_ESCAPE;
}

}  // namespace

App::App(Flags flags, std::vector<v1::Scene> views, std::unique_ptr<Window> window,
         std::shared_ptr<const client::Connection> connection)
    : flags_(std::move(flags)),
      window_(std::move(window)),
      told_window_(WindowOf(*window_, flags_.saves_bytes)),
      wake_event_(SDL_RegisterEvents(1)),
      flow_({[this] { Wake(); }, [this](const v1::Frame& frame) { session_.VideoLost(frame); },
             [this](const std::string& failure) {
               const std::lock_guard lock(failure_mutex_);
               failure_ = failure;
             }}),
      catalogue_(connection, [this] { Wake(); }),
      session_(connection, MakeSessionOptions(views), *this),
      ui_(session_, catalogue_),
      stage_(ui_),
      kiosk_(std::move(views), flags_.view_seconds),
      status_(flags_.status_file,
              flags_.status_always ? std::chrono::milliseconds(0) : StatusLog::kInterval),
      pointer_([this](const PointerInput::Motion& motion) { ui_.Move(motion); }),
      keys_(MakeKeyActions()) {
  ui_.choices.name = flags_.name;
  ui_.toggle_full_screen = [this] { window_->ToggleFullScreen(); };
}

// Stops the decoding thread first: it reports lost video to the session, and the session's thread
// offers frames to it.
App::~App() { flow_.Stop(); }

client::SessionOptions App::MakeSessionOptions(const std::vector<v1::Scene>& views) const {
  client::SessionOptions options;
  options.key = flags_.key;
  options.name = flags_.name;
  options.scene.set_storm_id(flags_.storm);
  // The session starts with the first view, so that the server's default view does not appear
  // briefly.
  if (!views.empty()) LayView(views.front(), options.scene);
  options.codecs = client::PictureDecoder::Codecs();
  options.window = told_window_;
  options.never_gives_up = flags_.kiosk;
  return options;
}

KeyActions App::MakeKeyActions() {
  KeyActions keys;
  keys.move = [this](const auto& motion) { ui_.Move(motion); };
  keys.home = [this] { ui_.ShowCamera(client::HomeCamera(ui_.state.ViewCamera().kind_case())); };
  keys.toggle_tool = [this](Tool tool) { ui_.choices.Toggle(tool); };
  keys.toggle_panel = [this](Panel panel) { ui_.choices.Toggle(panel); };
  keys.toggle_play = [this] { ui_.TogglePlay(); };
  keys.step_time = [this](int by) { ui_.StepTime(by); };
  keys.undo = [this] { ui_.Undo(); };
  keys.redo = [this] { ui_.Redo(); };
  keys.full_screen = [this] { window_->ToggleFullScreen(); };
  keys.focus_panel = [this] { FocusPanel(); };
  keys.escape = [this] { Escape(); };
  return keys;
}

void App::FocusPanel() {
  ui_.choices.focuses_panel = ui_.choices.tool != Tool::kNone || ui_.choices.panel != Panel::kNone;
}

void App::Escape() {
  if (!ui_.choices.Close() && window_->full_screen()) window_->ToggleFullScreen();
}

void App::StreamBegan() {
  flow_.StartStream();
  statistics_.StreamBegan();
}

void App::Received(v1::Frame frame, std::size_t bytes) {
  statistics_.Received(bytes, Clock::now());
  flow_.Offer(std::move(frame), bytes);
}

void App::SceneTaken(std::uint64_t revision, Clock::time_point sent_at) {
  statistics_.SceneTaken(revision, sent_at);
}

void App::Wake() {
  if (woken_.exchange(true)) return;
  SDL_Event event{};
  event.type = wake_event_;
  SDL_PushEvent(&event);
}

int App::Timeout_ms(Clock::time_point now) const {
  const bool moves =
      flags_.turn_deg_per_s != 0.0 || ui_.playback.playing() || now < redraw_until_ || redraws_ > 0;
  constexpr int kIdle_ms = 500;
  return moves ? static_cast<int>(kFrame.count()) : kIdle_ms;
}

void App::Run() {
  Clock::time_point drawn_at{};
  bool stale = true;
  while (true) {
    const auto begin = Clock::now();
    const std::chrono::duration<double> ran = begin - start_;
    if (flags_.seconds > 0.0 && ran.count() > flags_.seconds) break;
    if (!TakeEvents(Timeout_ms(begin))) break;
    const auto now = Clock::now();
    stale |= ui_.Refresh();
    if (std::exchange(ui_.texts_changed, false)) Unsettle(now);
    Advance(now);
    stale |= TakePicture();
    // The window is drawn at least once a second, because the shown times and statistics change.
    stale |= now < redraw_until_ || redraws_ > 0 || now - drawn_at > std::chrono::seconds(1);
    if (window_->minimized()) settling_draws_ = redraws_ = 0;
    if (settling_draws_ > 0) {
      --settling_draws_;
      stale = true;
    }
    if (stale && !window_->minimized()) {
      Draw();
      drawn_at = now;
      stale = false;
    }
    ui_.typing = FocusNow().text;
    status_.Write(ui_, kiosk_.shown(), input_, Clock::now());
  }
  if (flags_.seconds > 0.0) PrintSummary();
}

void App::Unsettle(Clock::time_point now) {
  redraw_until_ = now + kSettles;
  redraws_ = kSettlingDraws;
  input_.drawings = 0;
}

bool App::TakeEvents(int timeout_ms) {
  if (settling_draws_ > 0) return true;
  SDL_Event event;
  if (SDL_WaitEventTimeout(&event, timeout_ms) == 0) return true;
  do {
    if (event.type == SDL_QUIT) return false;
    if (event.type == wake_event_) {
      woken_ = false;
    } else {
      TakeEvent(event);
      if (MovesFocus(event)) settling_draws_ = kFocusDraws;
      // ImGui sees a key only if the key is down during a drawing. A press and a release between
      // two drawings would be lost, so the window is drawn before more events are handled.
      const KeyFocus focus = FocusNow();
      if (event.type == SDL_KEYDOWN && (focus.text || focus.controls)) {
        settling_draws_ = std::max(settling_draws_, 1);
      }
    }
  } while (settling_draws_ == 0 && SDL_PollEvent(&event) != 0);
  return true;
}

void App::TakeEvent(const SDL_Event& event) {
  window_->Take(event);
  Unsettle(Clock::now());
  input_.Take(event);
  if (event.type == SDL_WINDOWEVENT) resized_at_ = Clock::now();
  if (flags_.kiosk) return;
  pointer_.SetSize(window_->width(), window_->height());
  pointer_.SetTool(stage_.HandTool());
  const KeyFocus focus = FocusNow();
  if (event.type == SDL_KEYDOWN) {
    TakeKey(event.key, focus, keys_);
  } else if (event.type == SDL_TEXTINPUT) {
    TakeText(event.text.text, static_cast<Uint16>(SDL_GetModState()), focus, keys_);
  } else {
    const ScreenPoint at = PlaceOf(event);
    pointer_.Take(event, !window_->IsOverPanel(at.x, at.y));
  }
}

bool App::TakePicture() {
  std::unique_ptr<client::Picture> picture = flow_.Take();
  if (picture == nullptr) return false;
  texture_.Upload(picture->pixels);
  ui_.frame = picture->frame;
  ui_.encoding = picture->encoding;
  ui_.failure.clear();
  session_.Shown(picture->frame);
  const auto now = Clock::now();
  if (picture->frame.own_view()) {
    statistics_.ShownOwn(picture->decode_ms, now);
  } else {
    statistics_.Shown(picture->frame.scene_revision(), picture->decode_ms, now);
  }
  flow_.Return(std::move(picture));
  return true;
}

void App::Advance(Clock::time_point now) {
  ui_.figures = statistics_.At(now);
  ui_.dropped = flow_.dropped();
  {
    const std::lock_guard lock(failure_mutex_);
    if (!failure_.empty()) ui_.failure = std::exchange(failure_, {});
  }
  if (ui_.state.link == client::Link::kLive) last_live_ = now;
  TellWindow(now);
  Turn(now);
  if (flags_.kiosk) kiosk_.Advance(ui_, now);
  if (const auto next =
          ui_.playback.Advance(ui_.time_index(), ui_.time_count(), ui_.IsShown(), now)) {
    ui_.ShowTime(*next, Ui::Recording::kUnrecorded);
  }
}

void App::Turn(Clock::time_point now) {
  const double seconds =
      std::chrono::duration<double>(now - std::exchange(turned_at_, now)).count();
  constexpr double kLongest_s = 0.25;
  if (flags_.turn_deg_per_s == 0.0 || seconds > kLongest_s) return;
  ui_.Move([&](const client::Pose& pose) {
    return client::Turn(pose, flags_.turn_deg_per_s * seconds, 0.0);
  });
}

// Reports the window's size to the server. If this client presents and steers, the session's
// picture also gets that size.
void App::TellWindow(Clock::time_point now) {
  if (now - resized_at_ < kResizeSettles) return;
  const v1::Window window = WindowOf(*window_, flags_.saves_bytes);
  if (Differs(window, told_window_)) {
    told_window_ = window;
    session_.SetWindow(window);
  }
  const v1::Output& output = ui_.state.scene.output();
  const bool fits =
      output.width_px() == window.width_px() && output.height_px() == window.height_px();
  if (fits || window.hidden() || !ui_.state.Presents() || !ui_.state.Steers()) return;
  const client::Limits limits = client::LimitsOf<v1::Output>("width_px");
  const auto width = static_cast<std::uint32_t>(client::Clamp(window.width_px(), limits));
  const auto height = static_cast<std::uint32_t>(client::Clamp(window.height_px(), limits));
  if (width == output.width_px() && height == output.height_px()) return;
  session_.Edit([=](v1::Scene& scene) {
    scene.mutable_output()->set_width_px(width);
    scene.mutable_output()->set_height_px(height);
  });
}

void App::Draw() {
  redraws_ = std::max(0, redraws_ - 1);
  ui_.scale = window_->scale();
  ui_.width = window_->width();
  ui_.height = window_->height();
  window_->Draw([this] {
    stage_.Draw(texture_);
    if (flags_.kiosk) return DrawKiosk();
    const Layout layout = Layout::Of(ui_.width, ui_.height, ui_.scale);
    DrawTopBar(ui_, layout);
    DrawToolRail(ui_, layout);
    DrawTool(ui_, layout);
    DrawTimeLine(ui_, layout);
    DrawSessionBar(ui_, layout);
    DrawNotices(ui_, layout);
    DrawPanel(ui_, layout);
    ui_.choices.focuses_panel = false;
  });
  ++input_.drawings;
}

void App::DrawKiosk() {
  const std::string warning = kiosk_.Warning(ui_, last_live_, Clock::now());
  if (warning.empty()) return;
  const float margin = 16.0F * ui_.scale;
  const ImVec2 size = ImGui::CalcTextSize(warning.c_str());
  const ImVec2 at(margin, ui_.height - size.y - margin);
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddRectFilled({at.x - 0.5F * margin, at.y - 0.4F * margin},
                     {at.x + size.x + 0.5F * margin, at.y + size.y + 0.4F * margin},
                     ImGui::GetColorU32({0.0F, 0.0F, 0.0F, 0.75F}), 0.4F * margin);
  list.AddText(at, ImGui::GetColorU32(kBad), warning.c_str());
}

void App::PrintSummary() const {
  const auto figures = statistics_.At(Clock::now());
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  std::printf(
      "%s", absl::StrFormat("%d pictures in %.1f s: %.1f a second; %d x %d %s; latency %.0f ms; "
                            "decoded in %.1f ms; %d left out; %.1f MB received; %.1f MB resident\n",
                            figures.frames, seconds, static_cast<double>(figures.frames) / seconds,
                            ui_.frame.width_px(), ui_.frame.height_px(), ui_.encoding,
                            figures.latency_ms.value_or(0.0), figures.decode_ms, flow_.dropped(),
                            static_cast<double>(figures.bytes) / 1e6,
                            static_cast<double>(ResidentBytes()) / 1e6)
                .c_str());
}

int RunDesktop(Flags flags) {
  constexpr int kUsage = 64;
  constexpr int kUnavailable = 69;
  const auto fail = [](const absl::Status& status, int exit_status) {
    std::fprintf(stderr, "thunderhead-desktop: %s\n", std::string(status.message()).c_str());
    return exit_status;
  };
  std::vector<v1::Scene> views;
  for (const std::string& path : flags.views) {
    absl::StatusOr<v1::Scene> view = ReadScene(path);
    if (!view.ok()) return fail(view.status(), kUsage);
    views.push_back(*std::move(view));
  }
  auto connection = client::Connection::Open(flags.access);
  if (!connection.ok()) return fail(connection.status(), kUsage);
  const absl::Status status_file = StatusLog::CheckWritable(flags.status_file);
  if (!status_file.ok()) return fail(status_file, kUsage);
  WindowOptions options;
  options.width = flags.width;
  options.height = flags.height;
  options.full_screen = flags.full_screen || flags.kiosk;
  options.hides_cursor = flags.kiosk;
  options.scale = flags.scale;
  auto window = Window::Open(options);
  if (!window.ok()) return fail(window.status(), kUnavailable);
  App app(std::move(flags), std::move(views), *std::move(window), *connection);
  app.Run();
  return 0;
}

}  // namespace thunderhead::desktop
