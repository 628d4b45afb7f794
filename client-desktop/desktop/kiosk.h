// A wall's display: shows views in turn, without controls, and says when its picture is old. A
// plain value with a clock given.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "desktop/ui.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::desktop {

// Puts what the view says in place of the scene's: lists and the camera as a whole.
void LayView(const v1::Scene& view, v1::Scene& scene);

class Kiosk {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  Kiosk(std::vector<v1::Scene> views, double view_seconds);

  // Shows the next view if it is due: the whole of it where this window steers, else its camera as
  // an own view. A single view is shown again where another session or somebody else has undone it.
  void Advance(Ui& ui, TimePoint now);
  // The index of the view shown; -1 before the first.
  int shown() const { return shown_; }
  // The warning that the picture is old, as the connection has been lost for a while, or that the
  // scene cannot be drawn; else empty.
  static std::string Warning(const Ui& ui, TimePoint last_live, TimePoint now);

 private:
  // True while nothing has undone the view that was shown last.
  bool Stands(const client::SessionState& state) const;

  const std::vector<v1::Scene> views_;
  const std::chrono::duration<double> interval_;
  int shown_ = -1;
  TimePoint shown_at_{};
  int shown_in_ = 0;  // the state's joined_count then
  bool steered_ = false;
};

}  // namespace thunderhead::desktop
