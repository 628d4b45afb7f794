// The running program: the window, the session, and the event loop that connects them.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "desktop/flags.h"
#include "desktop/input_tally.h"
#include "desktop/keyboard.h"
#include "desktop/kiosk.h"
#include "desktop/picture_texture.h"
#include "desktop/pointer_input.h"
#include "desktop/stage.h"
#include "desktop/status_log.h"
#include "desktop/ui.h"
#include "desktop/window.h"
#include "thunderhead_client/picture_flow.h"
#include "thunderhead_client/session.h"
#include "thunderhead_client/statistics.h"

namespace thunderhead::desktop {

class App final : private client::SessionListener {
 public:
  App(Flags flags, std::vector<v1::Scene> views, std::unique_ptr<Window> window,
      std::shared_ptr<const client::Connection> connection);
  ~App() override;

  // Runs until the window is closed or the time of the flag --seconds is over.
  void Run();

 private:
  using Clock = std::chrono::steady_clock;

  // SessionListener's methods run on the session's thread.
  void Changed() override { Wake(); }
  void StreamBegan() override;
  void Received(v1::Frame frame, std::size_t bytes) override;
  void SceneTaken(std::uint64_t revision, Clock::time_point sent_at) override;

  // Wakes the event loop. Any thread may call this.
  void Wake();
  bool TakeEvents(int timeout_ms);
  void TakeEvent(const SDL_Event& event);
  bool TakePicture();
  // Schedules the drawings that ImGui needs after an event or new texts, until layout and focus no
  // longer change.
  void Unsettle(Clock::time_point now);
  void Advance(Clock::time_point now);
  void Turn(Clock::time_point now);
  void TellWindow(Clock::time_point now);
  void Draw();
  void DrawKiosk();
  void FocusPanel();
  void Escape();
  KeyActions MakeKeyActions();
  client::SessionOptions MakeSessionOptions(const std::vector<v1::Scene>& views) const;
  int Timeout_ms(Clock::time_point now) const;
  void PrintSummary() const;

  const Flags flags_;
  const std::unique_ptr<Window> window_;
  v1::Window told_window_;  // last size reported to the server
  client::Statistics statistics_;
  std::atomic<bool> woken_{false};
  Uint32 wake_event_ = 0;
  PictureTexture texture_;
  std::mutex failure_mutex_;
  std::string failure_;
  client::PictureFlow flow_;
  client::Catalogue catalogue_;
  client::Session session_;
  Ui ui_;
  Stage stage_;
  Kiosk kiosk_;
  StatusLog status_;
  PointerInput pointer_;
  KeyActions keys_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_live_ = Clock::now();
  InputTally input_;
  Clock::time_point redraw_until_{};
  int redraws_ = 0;  // minimum number of drawings that must still follow, however long they take
  // Number of drawings required before more input is handled. Only after a drawing does ImGui
  // report whether a text field has the keyboard.
  int settling_draws_ = 0;
  Clock::time_point resized_at_{};
  Clock::time_point turned_at_{};
};

// Runs the program, and returns the exit status.
int RunDesktop(Flags flags);

}  // namespace thunderhead::desktop
