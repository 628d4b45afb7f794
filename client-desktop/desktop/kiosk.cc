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

void LayView(const v1::Scene& view, v1::Scene& scene) {
  // Fields of one kind of camera merged into another kind's would mix two views, and the server
  // takes each field once.
  if (view.has_camera()) scene.clear_camera();
  if (view.fields_size() > 0) scene.clear_fields();
  if (view.lights_size() > 0) scene.clear_lights();
  const std::string storm = scene.storm_id();
  scene.MergeFrom(view);
  if (!view.storm_id().empty() && view.storm_id() != storm && !view.has_time_index()) {
    scene.clear_time_index();
  }
}

bool Kiosk::Stands(const client::SessionState& state) const {
  const bool shows = state.Steers() || state.looks_around;
  return shows && state.Steers() == steered_ && state.joined_count == shown_in_;
}

void Kiosk::Advance(Ui& ui, TimePoint now) {
  if (views_.empty() || ui.state.link != client::Link::kLive) return;
  if (!ui.state.Steers() && !ui.state.MayLookAround()) return;
  const bool due = now - shown_at_ >= interval_;
  const bool first = shown_ < 0;
  if (!first && (!due || (views_.size() == 1 && Stands(ui.state)))) return;
  const int next = (shown_ + 1) % static_cast<int>(views_.size());
  const v1::Scene& view = views_.at(static_cast<std::size_t>(next));
  if (ui.state.Steers()) {
    if (!ui.session.Edit([view](v1::Scene& scene) { LayView(view, scene); })) return;
  } else if (view.has_camera()) {
    if (!ui.session.ShowCamera(view.camera())) return;
  }
  shown_ = next;
  shown_at_ = now;
  shown_in_ = ui.state.joined_count;
  steered_ = ui.state.Steers();
}

std::string Kiosk::Warning(const Ui& ui, TimePoint last_live, TimePoint now) {
  if (ui.state.link == client::Link::kLive) {
    return ui.state.problem ? ui.state.problem->message() : "";
  }
  if (now - last_live < kQuietLoss) return "";
  const auto minutes = std::chrono::floor<std::chrono::minutes>(now - last_live).count();
  const std::string since =
      minutes < 1 ? "for less than a minute" : absl::StrCat("for ", minutes, " min");
  return absl::StrCat("No connection to the server ", since, ": this picture is old. ",
                      ui.state.reason);
}

}  // namespace thunderhead::desktop
