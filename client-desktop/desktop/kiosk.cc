#include "desktop/kiosk.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::desktop {
namespace {

// A connection loss shorter than this shows no warning.
constexpr std::chrono::seconds kQuietLoss{10};
// If the picture of a view never arrives, for example because its storm is unreadable, the kiosk
// shows the next view after this time.
constexpr std::chrono::minutes kMostWait{2};

}  // namespace

Kiosk::Kiosk(std::vector<v1::Scene> views, double view_seconds)
    : views_(std::move(views)), interval_(view_seconds) {}

void LayView(const v1::Scene& view, v1::Scene& scene) {
  v1::Scene laid = view;
  const bool same_storm = view.storm_id().empty() || view.storm_id() == scene.storm_id();
  if (same_storm) {
    laid.set_storm_id(scene.storm_id());
    if (!view.has_time_index() && scene.has_time_index()) laid.set_time_index(scene.time_index());
  }
  *laid.mutable_output() = scene.output();
  scene = std::move(laid);
}

bool Kiosk::ShowsOwnView() const {
  return views_.at(static_cast<std::size_t>(shown_)).has_camera();
}

void Kiosk::Advance(Ui& ui, TimePoint now) {
  const client::SessionState& state = ui.state;
  // The server reports who is in control only after joining. A camera requested before that would
  // begin an own view instead.
  const bool known = state.link == client::Link::kLive && state.presence.people_size() > 0;
  if (views_.empty() || !known || (!state.Steers() && !state.MayLookAround())) return;
  const bool first = shown_ < 0;
  // True if the kiosk has joined again, or has gained or lost control, or if its own view has ended
  // since the view was shown. The view must then be shown again.
  const bool undone = !first && (state.joined_count != shown_in_ || state.Steers() != steered_ ||
                                 (ShowsOwnView() && !state.Steers() && !state.looks_around));
  // A view's time begins when its picture is shown.
  const bool pictured = !state.Steers() || ui.frame.scene_revision() >= state.scene_revision;
  if (!pictured && now - asked_at_ < kMostWait) shown_at_ = now;
  const bool due = now - shown_at_ >= interval_ && views_.size() > 1;
  if (!first && !undone && !due) return;
  const int next = first || due ? (shown_ + 1) % static_cast<int>(views_.size()) : shown_;
  const v1::Scene& view = views_.at(static_cast<std::size_t>(next));
  if (state.Steers()) {
    if (!ui.session.Edit([view](v1::Scene& scene) { LayView(view, scene); })) return;
  } else if (view.has_camera()) {
    if (!ui.session.ShowCamera(view.camera())) return;
  }
  ++ui.edits;
  shown_ = next;
  asked_at_ = shown_at_ = now;
  shown_in_ = state.joined_count;
  steered_ = state.Steers();
  notices_ = state.notice_count;
}

std::string Kiosk::Warning(const Ui& ui, TimePoint last_live, TimePoint now) const {
  if (ui.state.link == client::Link::kLive) {
    if (ui.state.problem) return ui.state.problem->message();
    // The notice says why the server has refused the view.
    return shown_ >= 0 && ui.state.notice_count != notices_ ? ui.state.notice : "";
  }
  if (now - last_live < kQuietLoss) return "";
  const auto minutes = std::chrono::floor<std::chrono::minutes>(now - last_live).count();
  const std::string since =
      minutes < 1 ? "for less than a minute" : absl::StrCat("for ", minutes, " min");
  return absl::StrCat("No connection to the server ", since, ": this picture is old. ",
                      ui.state.reason);
}

}  // namespace thunderhead::desktop
