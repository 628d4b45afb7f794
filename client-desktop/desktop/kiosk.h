// A wall display. It shows views in turn, without controls, and warns when its picture is old. This
// is a plain value; the caller passes the time.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "desktop/ui.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

// Replaces the scene by the view, like `render --scene`: the server chooses what the view leaves
// out. The scene keeps its picture size, and also its storm and time if the view names none.
void LayView(const v1::Scene& view, v1::Scene& scene);

class Kiosk {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  Kiosk(std::vector<v1::Scene> views, double view_seconds);

  // Shows the next view if it is due. If this window steers, it applies the whole view, otherwise
  // only the view's camera as an own view. A view is due after the previous picture was shown for
  // its time, or did not arrive for two minutes. If another session or another viewer has undone a
  // view, it is shown again at once.
  void Advance(Ui& ui, TimePoint now);
  // Returns the index of the view shown; -1 before the first.
  int shown() const { return shown_; }
  // Returns a warning if the picture is old because the connection was lost for a while. Also warns
  // if the view was refused or cannot be drawn. Otherwise returns an empty string.
  std::string Warning(const Ui& ui, TimePoint last_live, TimePoint now) const;

 private:
  // Returns true if the view shown has a camera. It is an own view if this window does not steer.
  bool ShowsOwnView() const;

  const std::vector<v1::Scene> views_;
  const std::chrono::duration<double> interval_;
  int shown_ = -1;
  TimePoint asked_at_{};
  TimePoint shown_at_{};
  int shown_in_ = 0;  // the state's joined_count at that time
  bool steered_ = false;
  int notices_ = 0;  // the state's notice_count at that time
};

}  // namespace thunderhead::desktop
