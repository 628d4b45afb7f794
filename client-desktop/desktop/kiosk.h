// The logic of a kiosk, which is a display without controls, for example on a wall. It shows views
// in turn, and warns when its picture is old. The class has no clock; the caller passes the time.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "desktop/ui.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

// Replaces the scene by the view. As in `thunderhead render --scene`, the server chooses every
// value that the view does not set. The scene keeps its picture size. It also keeps its storm and
// time, unless the view names another storm or a time.
void LayView(const v1::Scene& view, v1::Scene& scene);

class Kiosk {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  Kiosk(std::vector<v1::Scene> views, double view_seconds);

  // Shows the next view if it is due. If this window steers, the whole view becomes the session's
  // scene. Otherwise this window shows the view's camera as its own view. A view is due after the
  // previous view's picture was shown for `view_seconds`, or has not arrived for two minutes. A
  // view that was undone by another viewer or by a new session is shown again at once.
  void Advance(Ui& ui, TimePoint now);
  // Returns the index of the view that is shown; -1 before the first view.
  int shown() const { return shown_; }
  // Returns a warning text if the connection has been lost for a while, or if the server refused
  // the view or cannot draw it. Otherwise returns an empty string.
  std::string Warning(const Ui& ui, TimePoint last_live, TimePoint now) const;

 private:
  // Returns true if the view that is shown has a camera, which a window that does not steer shows
  // as its own view.
  bool ShowsOwnView() const;

  const std::vector<v1::Scene> views_;
  const std::chrono::duration<double> interval_;
  int shown_ = -1;
  TimePoint asked_at_{};
  TimePoint shown_at_{};
  int shown_in_ = 0;  // SessionState::joined_count when the view was shown
  bool steered_ = false;
  int notices_ = 0;  // SessionState::notice_count when the view was shown
};

}  // namespace thunderhead::desktop
