// A wall's display: shows views in turn, without controls, and says when its picture is old. A
// plain value with a clock given.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "desktop/ui.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

class Kiosk {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  Kiosk(std::vector<v1::Scene> views, double view_seconds);

  // Shows the next view if it is due: the whole of it where this window steers, else its camera as
  // an own view.
  void Advance(Ui& ui, TimePoint now);
  // The index of the view shown; -1 before the first.
  int shown() const { return shown_; }
  // The warning that the picture is old; empty unless the connection has been lost for a while.
  static std::string Warning(const Ui& ui, TimePoint last_live, TimePoint now);

 private:
  const std::vector<v1::Scene> views_;
  const std::chrono::duration<double> interval_;
  int shown_ = -1;
  TimePoint shown_at_{};
};

}  // namespace thunderhead::desktop
