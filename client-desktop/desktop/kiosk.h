// A wall's display: shows views in turn, without controls, and says when its picture is old. A
// plain value with a clock given.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "desktop/ui.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

// Makes the view the scene, as `render --scene` reads it: what it does not say is left to the
// server. Storm and time stay where it names none, and the picture's size.
void LayView(const v1::Scene& view, v1::Scene& scene);

class Kiosk {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  Kiosk(std::vector<v1::Scene> views, double view_seconds);

  // Shows the next view if it is due: the whole of it where this window steers, else its camera as
  // an own view. A view is due when the picture of the one before has been shown for its time, or
  // has not come for two minutes. Shows a view again at once where another session or somebody else
  // has undone it.
  void Advance(Ui& ui, TimePoint now);
  // The index of the view shown; -1 before the first.
  int shown() const { return shown_; }
  // The warning that the picture is old, as the connection has been lost for a while, or that the
  // view is refused or cannot be drawn; else empty.
  std::string Warning(const Ui& ui, TimePoint last_live, TimePoint now) const;

 private:
  // The view shown has a camera, which is an own view where this window does not steer.
  bool ShowsOwnView() const;

  const std::vector<v1::Scene> views_;
  const std::chrono::duration<double> interval_;
  int shown_ = -1;
  TimePoint asked_at_{};
  TimePoint shown_at_{};
  int shown_in_ = 0;  // the state's joined_count then
  bool steered_ = false;
  int notices_ = 0;  // the state's notice_count then
};

}  // namespace thunderhead::desktop
