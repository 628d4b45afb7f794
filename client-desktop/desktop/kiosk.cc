#include "desktop/kiosk.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::desktop {
namespace {

// A connection that comes back at once is of no interest on a wall.
constexpr std::chrono::seconds kQuietLoss{10};

}  // namespace

Kiosk::Kiosk(std::vector<v1::Scene> views, double view_seconds)
    : views_(std::move(views)), interval_(view_seconds) {}

void Kiosk::Advance(Ui& ui, TimePoint now) {
  if (views_.empty() || ui.state.link != client::Link::kLive) return;
  if (!ui.state.Steers() && !ui.state.MayLookAround()) return;
  const bool due = now - shown_at_ >= interval_;
  const bool first = shown_ < 0;
  if (!first && (!due || views_.size() == 1)) return;
  const int next = (shown_ + 1) % static_cast<int>(views_.size());
  const v1::Scene& view = views_.at(static_cast<std::size_t>(next));
  if (ui.state.Steers()) {
    const bool edited = ui.session.Edit([view](v1::Scene& scene) {
      // A view says all of the camera: fields merged into another kind's would mix two views.
      if (view.has_camera()) scene.clear_camera();
      const std::string storm = scene.storm_id();
      scene.MergeFrom(view);
      if (!view.storm_id().empty() && view.storm_id() != storm && !view.has_time_index()) {
        scene.clear_time_index();
      }
    });
    if (!edited) return;
  } else if (view.has_camera()) {
    if (!ui.session.ShowCamera(view.camera())) return;
  }
  shown_ = next;
  shown_at_ = now;
}

std::string Kiosk::Warning(const Ui& ui, TimePoint last_live, TimePoint now) {
  if (ui.state.link == client::Link::kLive || now - last_live < kQuietLoss) return "";
  const auto minutes = std::chrono::floor<std::chrono::minutes>(now - last_live).count();
  const std::string since =
      minutes < 1 ? "for less than a minute" : absl::StrCat("for ", minutes, " min");
  return absl::StrCat("No connection to the server ", since, ": this picture is old. ",
                      ui.state.reason);
}

}  // namespace thunderhead::desktop
