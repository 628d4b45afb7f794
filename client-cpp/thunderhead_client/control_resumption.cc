#include "thunderhead_client/control_resumption.h"

#include <algorithm>
#include <utility>

namespace thunderhead::client {

void ControlResumption::Rejoined(std::uint64_t viewer_id, const v1::Presence& presence) {
  const bool steered = viewer_id != 0 && presence.steering_viewer_id() == viewer_id;
  if (!steered && own_ids_.empty()) return;
  if (own_ids_.empty()) {
    known_.clear();
    for (const v1::Person& person : presence.people()) known_.insert(person.viewer_id());
  }
  own_ids_.insert(viewer_id);
  takes_ = true;
}

ControlResumption::Outcome ControlResumption::Of(const v1::Presence& presence, bool presents) {
  if (own_ids_.empty() || !Awaits(presence, presents)) {
    End();
    return Outcome::kLost;
  }
  // The client takes control only once. An older presence message may arrive after the request was
  // sent. A second request could then take control from a colleague who got it meanwhile.
  const bool takes = std::exchange(takes_, false);
  return presents && takes ? Outcome::kTakes : Outcome::kWaits;
}

// Returns true if this person may still get control back. This is so if no viewer steers, or if
// this person's lost connection still steers. It is also so if a presenter who was not present
// before steers, because that presenter reached a restarted server first. A colleague who was
// present before and took control keeps it.
bool ControlResumption::Awaits(const v1::Presence& presence, bool presents) const {
  const std::uint64_t steering = presence.steering_viewer_id();
  if (steering == 0 || own_ids_.contains(steering)) return true;
  const auto steerer = std::ranges::find(presence.people(), steering, &v1::Person::viewer_id);
  const bool came = steerer != presence.people().end() && steerer->role() == v1::ROLE_PRESENTER &&
                    !known_.contains(steering);
  return presents && takes_ && came;
}

}  // namespace thunderhead::client
