#include "thunderhead_client/scene_sync.h"

#include <algorithm>

namespace thunderhead::client {
namespace {

// Several scenes may be in flight, so that a drag over a slow link need not wait for each response.
// At a round trip of 150 ms the client sends 26 scenes a second.
constexpr std::size_t kMaxInFlight = 4;
// If there are more edits than this, they are merged into one edit. They would otherwise accumulate
// while the server does not answer.
constexpr std::size_t kMaxEdits = 256;
constexpr std::chrono::milliseconds kBusyRest{500};
constexpr std::chrono::milliseconds kStaleRest{1000};

}  // namespace

void SceneSync::Edited(Edit edit) {
  edit(scene_);
  edits_.push_back({++last_edit_, std::move(edit)});
  unsent_ = true;
  if (edits_.size() > kMaxEdits) Merge();
  GiveUp();
}

void SceneSync::Merge() {
  edits_.clear();
  edits_.push_back({last_edit_, [whole = scene_](v1::Scene& scene) { scene = whole; }});
}

void SceneSync::Told(const v1::Scene& scene, std::uint64_t revision) {
  if (told_ && revision < told_->revision) return;
  told_ = Version{scene, revision};
  if (!revision_ || revision > *revision_) stale_until_.reset();
  AdoptTold();
}

void SceneSync::AdoptTold() {
  if (!told_ || !sent_.empty()) return;
  if (revision_ && told_->revision < *revision_) return;
  Rebase(*told_);
}

void SceneSync::Rebase(const Version& version) {
  revision_ = version.revision;
  scene_ = version.scene;
  for (const Numbered& each : edits_) each.edit(scene_);
}

void SceneSync::Rejoined() {
  revision_.reset();
  told_.reset();
  sent_.clear();
  drains_ = false;
  discards_ = false;
  stale_until_.reset();
  busy_until_.reset();
  unsent_ = !edits_.empty();
}

void SceneSync::Discard() {
  discards_ = true;
  GiveUp();
}

void SceneSync::GiveUp() {
  if (!discards_ || !sent_.empty() || edits_.empty()) return;
  edits_.clear();
  unsent_ = false;
  if (told_) Rebase(*told_);
  discarded_ = true;
}

std::optional<SceneSync::Outgoing> SceneSync::Next(TimePoint now) {
  if (edits_.empty() || !revision_) return {};
  if ((stale_until_ && now < *stale_until_) || (busy_until_ && now < *busy_until_)) return {};
  if (!sent_.empty() && (drains_ || !unsent_ || sent_.size() >= kMaxInFlight)) return {};
  stale_until_.reset();
  busy_until_.reset();
  Outgoing outgoing{++last_ticket_, scene_, sent_.empty() ? *revision_ : awaited_};
  awaited_ = outgoing.expected_revision + 1;
  sent_[outgoing.ticket] = {last_edit_, outgoing.expected_revision, scene_};
  unsent_ = false;
  return outgoing;
}

std::optional<SceneSync::TimePoint> SceneSync::WakeAt() const {
  if (edits_.empty()) return {};
  if (stale_until_ && busy_until_) return std::max(*stale_until_, *busy_until_);
  return stale_until_ ? stale_until_ : busy_until_;
}

void SceneSync::Taken(std::uint64_t ticket, std::uint64_t revision) {
  const auto found = sent_.find(ticket);
  if (found == sent_.end()) return;
  const Sent sent = std::move(found->second);
  sent_.erase(found);
  if (revision != sent.expected_revision + 1) drains_ = true;
  Drop(sent.last_edit);
  if (!revision_ || revision > *revision_) revision_ = revision;
  // The server sends its own scene only a few times a second. The accepted scene is therefore
  // remembered as the server's newest scene, to which a later refusal returns.
  if (!told_ || told_->revision < revision) told_ = Version{sent.scene, revision};
  Answered();
}

void SceneSync::Refused(std::uint64_t ticket, Refusal refusal, TimePoint now) {
  const auto found = sent_.find(ticket);
  if (found == sent_.end()) return;
  const std::uint64_t last_edit = found->second.last_edit;
  sent_.erase(found);
  const bool follows =
      drains_ &&
      refusal == Refusal::kStale;  // this scene was stale only because an earlier scene was refused
  drains_ = true;
  if (!follows) {
    if (refusal == Refusal::kRefused) {
      Drop(last_edit);
      if (told_) Rebase(*told_);
    } else if (refusal == Refusal::kBusy) {
      busy_until_ = now + kBusyRest;
    } else if (!told_ || !revision_ || told_->revision <= *revision_) {
      // The server normally sends the newer scene soon, and the edits are then applied to that
      // scene. If the newer scene does not arrive, the client sends its own scene again after
      // kStaleRest.
      stale_until_ = now + kStaleRest;
    }
  }
  Answered();
}

void SceneSync::Answered() {
  if (!sent_.empty()) return;
  drains_ = false;
  unsent_ = !edits_.empty();
  GiveUp();
  AdoptTold();
}

void SceneSync::Drop(std::uint64_t last_edit) {
  while (!edits_.empty() && edits_.front().number <= last_edit) edits_.pop_front();
}

}  // namespace thunderhead::client
