#include "thunderhead_client/session_state.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::client {

void SessionState::Take(const v1::Marks& told) {
  if (!told.only_changes()) {
    marks = told;
    return;
  }
  const auto find = [this](std::uint64_t id) {
    return std::ranges::find(*marks.mutable_marks(), id, &v1::Mark::mark_id);
  };
  for (const v1::Mark& mark : told.marks()) {
    const auto at = find(mark.mark_id());
    (at == marks.mutable_marks()->end() ? *marks.add_marks() : *at) = mark;
  }
  for (const std::uint64_t id : told.erased_mark_ids()) {
    if (const auto at = find(id); at != marks.mutable_marks()->end()) {
      marks.mutable_marks()->erase(at);
    }
  }
}

bool SessionState::Steers() const {
  return link == Link::kLive && viewer_id != 0 && presence.steering_viewer_id() == viewer_id;
}

bool SessionState::AsksControl() const {
  const v1::Person* const me = PersonOf(viewer_id);
  return me != nullptr && me->asks_control();
}

bool SessionState::SteersWhoAsks() const {
  // Control that is reserved for an absent viewer is not free, although no viewer steers.
  const bool free =
      presence.steering_viewer_id() == 0 && !presence.presenter_away() && !presence.has_awaited();
  return free && presence.rules().viewers_may_steer() && !presence.rules().control_locked();
}

bool SessionState::MayLookAround() const {
  return link == Link::kLive && (Presents() || !presence.rules().following_locked());
}

bool SessionState::MayMark() const {
  return link == Link::kLive && (Presents() || Steers() || presence.rules().viewers_may_mark());
}

const v1::Person* SessionState::Steerer() const { return PersonOf(presence.steering_viewer_id()); }

const v1::Person* SessionState::PersonOf(std::uint64_t id) const {
  for (const v1::Person& person : presence.people()) {
    if (person.viewer_id() == id && id != 0) return &person;
  }
  return nullptr;
}

std::string SessionState::NameOf(const v1::Person& person) const {
  if (!person.name().empty()) return person.name();
  if (person.role() == v1::ROLE_PRESENTER) return "Presenter";
  return absl::StrCat("Viewer ", person.viewer_id());
}

v1::Camera SessionState::ViewCamera() const {
  const v1::Camera& wanted = looks_around ? own_camera : scene.camera();
  const bool same_kind = wanted.kind_case() == shown_camera.kind_case() ||
                         wanted.kind_case() == v1::Camera::KIND_NOT_SET;
  if (PoseOf(wanted)) return wanted;
  return same_kind ? shown_camera : v1::Camera();
}

}  // namespace thunderhead::client
