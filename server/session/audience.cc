#include "session/audience.h"

#include <algorithm>
#include <utility>

#include "base/error_details.h"

namespace thunderhead::session {
namespace {

// The minimum pause between updates of the times in memory is zero, because the caller of Hold
// already limits how often they change.
constexpr std::chrono::milliseconds kAtOnce{0};

}  // namespace

Audience::Audience(const AudienceFormat& format, const Rules& rules, Board board, Time now,
                   std::function<void()> on_due, const RosterTimeouts& timeouts)
    : format_(format),
      on_due_(std::move(on_due)),
      roster_(rules, now, board.LastPerson(), timeouts),
      board_(std::move(board)) {}

std::optional<std::uint64_t> Audience::Join(Role role, const std::string& name,
                                            std::shared_ptr<delivery::Viewer> member, Time now,
                                            std::size_t most, const std::string& owner_key,
                                            bool answers_checks) {
  std::unique_lock lock(mutex_);
  const std::size_t lost = roster_.Has(role, owner_key) ? 1 : 0;
  if (role == Role::kViewer && members_.size() + onlookers_ >= most + lost) {
    return std::nullopt;
  }
  const std::uint64_t id = roster_.Join(role, name, now, owner_key, answers_checks);
  std::vector<std::shared_ptr<delivery::Viewer>> doubted;
  for (const Person& person : roster_.people()) {
    if (person.doubted_at == now) doubted.push_back(members_.at(person.id).viewer);
  }
  members_[id] = {std::move(member), roster_.revision()};
  board_.HandOver(owner_key, id);
  Settle(std::move(lock), now);
  for (const auto& asked : doubted) asked->Wake();
  return id;
}

void Audience::Leave(std::uint64_t id, Time now) {
  std::unique_lock lock(mutex_);
  Forget(id);
  roster_.Leave(id, now);
  Settle(std::move(lock), now);
}

bool Audience::AddOnlooker(Role role, std::size_t most) {
  const std::lock_guard lock(mutex_);
  if (role == Role::kViewer && members_.size() + onlookers_ >= most) return false;
  ++onlookers_;
  return true;
}

void Audience::RemoveOnlooker() {
  const std::lock_guard lock(mutex_);
  --onlookers_;
}

void Audience::Forget(std::uint64_t id) {
  members_.erase(id);
  rays_.erase(id);
  finding_.erase(id);
  board_.Point(id, std::nullopt);
}

void Audience::Heard(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  roster_.Heard(id);
}

void Audience::Checked(std::uint64_t id, std::uint64_t doubts, Time now) {
  std::unique_lock lock(mutex_);
  roster_.Checked(id, doubts, now);
  Settle(std::move(lock), now);
}

absl::Status Audience::Change(const RosterChange& change, Time now) {
  std::unique_lock lock(mutex_);
  absl::Status status = change(roster_);
  WithdrawPointers();
  Settle(std::move(lock), now);
  return status;
}

// Removes the pointers of people who may not mark.
void Audience::WithdrawPointers() {
  const auto may_not = [this](std::uint64_t id) { return !roster_.MayMark(id).ok(); };
  std::erase_if(rays_, [&](const auto& ray) { return may_not(ray.first); });
  std::erase_if(finding_, may_not);
  const std::vector<Pointer> pointers = board_.pointers();
  for (const Pointer& pointer : pointers) {
    if (may_not(pointer.person_id)) board_.Point(pointer.person_id, std::nullopt);
  }
}

absl::Status Audience::Erase(std::uint64_t id, const std::vector<std::uint64_t>& mark_ids,
                             Time now) {
  std::unique_lock lock(mutex_);
  const Person* const person = roster_.Find(id);
  const bool any = person != nullptr && person->role == Role::kPresenter;
  if (!any && board_.HasOfOthers(mark_ids, id)) {
    return base::WithDetails(
        absl::PermissionDeniedError("viewers can erase only their own marks; ask a presenter"),
        {.reason = "NOT_YOUR_MARK"});
  }
  board_.Erase(mark_ids, any ? std::nullopt : std::optional(id));
  Settle(std::move(lock), now);
  return absl::OkStatus();
}

absl::Status Audience::Draw(std::uint64_t id, const BoardChange& change, Time now) {
  std::unique_lock lock(mutex_);
  if (absl::Status may = roster_.MayMark(id); !may.ok()) return may;
  absl::Status status = change(board_);
  Settle(std::move(lock), now);
  return status;
}

absl::Status Audience::Point(std::uint64_t id, const std::optional<Ray>& ray, Time now) {
  std::unique_lock lock(mutex_);
  if (ray.has_value()) {
    if (absl::Status may = roster_.MayMark(id); !may.ok()) return may;
    rays_[id] = *ray;
  } else {
    rays_.erase(id);
    finding_.erase(id);
    board_.Point(id, std::nullopt);
  }
  Settle(std::move(lock), now);
  return absl::OkStatus();
}

void Audience::RestoreControl(const KeptControl& kept, Time now) {
  std::unique_lock lock(mutex_);
  roster_.RestoreControl(kept, now);
  Settle(std::move(lock), now);
}

void Audience::SceneChanged(std::uint64_t revision, const std::optional<std::string>& domain,
                            Time now) {
  std::unique_lock lock(mutex_);
  if (revision >= scene_revision_ && domain.has_value()) board_.ShowDomain(*domain);
  scene_revision_ = std::max(scene_revision_, revision);
  Settle(std::move(lock), now);
}

void Audience::Hold(const HeldTimes& held, Time now) {
  std::unique_lock lock(mutex_);
  if (held == held_) return;
  held_ = held;
  ++held_revision_;
  Settle(std::move(lock), now);
}

void Audience::WakeAll() {
  std::unique_lock lock(mutex_);
  const auto members = Members();
  lock.unlock();
  for (const auto& member : members) member->Wake();
}

Board Audience::Drawn() const {
  const std::lock_guard lock(mutex_);
  return board_;
}

Rules Audience::CurrentRules() const {
  const std::lock_guard lock(mutex_);
  return roster_.rules();
}

KeptControl Audience::ControlToKeep() const {
  const std::lock_guard lock(mutex_);
  return roster_.ControlToKeep();
}

std::uint64_t Audience::MarksRevision() const {
  const std::lock_guard lock(mutex_);
  return board_.marks_revision();
}

absl::Status Audience::MaySteer(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  return roster_.MaySteer(id);
}

absl::Status Audience::PresenterMaySteer() const {
  const std::lock_guard lock(mutex_);
  return roster_.PresenterMaySteer();
}

absl::Status Audience::MayMark(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  return roster_.MayMark(id);
}

std::uint64_t Audience::Returns(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const Person* const person = roster_.Find(id);
  return person == nullptr ? 0 : person->returns;
}

bool Audience::IsThere(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  return roster_.Find(id) != nullptr;
}

std::uint64_t Audience::Doubts(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const Person* const person = roster_.Find(id);
  return person == nullptr ? 0 : person->doubts;
}

bool Audience::Follows(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const Person* const person = roster_.Find(id);
  return person == nullptr || person->follows;
}

bool Audience::Empty() const {
  const std::lock_guard lock(mutex_);
  return members_.empty();
}

Told Audience::Presence(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const auto member = members_.find(id);
  const bool is_older =
      member != members_.end() && presence_.told_revision < member->second.joined_at;
  return is_older ? Told() : presence_.told;
}

Told Audience::Pointers() const {
  const std::lock_guard lock(mutex_);
  return pointers_.told;
}

Told Audience::Marks(std::uint64_t count) {
  const std::lock_guard lock(mutex_);
  Told& all = marks_.told;
  const std::uint64_t missed = all.count - count;
  if (missed == 0) return all;
  if (count > 0 && missed <= marks_changes_.size()) {
    return {count + 1, marks_changes_[marks_changes_.size() - missed]};
  }
  if (all.bytes == nullptr) {
    all.bytes = std::make_shared<const std::string>(format_.marks(board_.MarksShown()));
  }
  return all;
}

// Sends the change of the marks. All marks together are serialized only when a person needs them.
void Audience::TellMarks(Time now) {
  marks_ = {{marks_.told.count + 1, nullptr}, board_.marks_revision(), now};
  marks_changes_.push_back(
      std::make_shared<const std::string>(format_.marks_change(board_.TakeMarksChange())));
  if (marks_changes_.size() > kMaxMarksChanges) marks_changes_.pop_front();
}

Told Audience::TimesHeld() const {
  const std::lock_guard lock(mutex_);
  return held_times_.told;
}

Told Audience::Scene() const {
  const std::lock_guard lock(mutex_);
  return scene_.told;
}

std::optional<Audience::Time> Audience::Tick(Time now, const Place& place) {
  std::unique_lock lock(mutex_);
  std::vector<std::shared_ptr<delivery::Viewer>> gone;
  for (const std::uint64_t id : roster_.Advance(now)) {
    gone.push_back(members_.at(id).viewer);
    Forget(id);
  }
  // The positions are computed without the lock, because this takes a while.
  if (!rays_.empty() && now >= pointers_.told_at + kPointersPause) {
    const auto rays = TakeRays();
    for (const auto& [id, ray] : rays) finding_.insert(id);
    lock.unlock();
    std::vector<Pointer> found;
    found.reserve(rays.size());
    for (const auto& [id, ray] : rays) found.push_back({id, place(ray)});
    lock.lock();
    for (const Pointer& pointer : found) {
      // Skips pointers that were removed meanwhile.
      if (finding_.erase(pointer.person_id) > 0) {
        board_.Point(pointer.person_id, pointer.position_m);
      }
    }
  }
  const bool told = TellDue(now);
  std::optional<Time> next;
  const auto wait_for = [&](bool waits, Time time) {
    if (waits && (!next.has_value() || time < *next)) next = time;
  };
  wait_for(roster_.revision() > presence_.told_revision, presence_.told_at + kPresencePause);
  wait_for(board_.marks_revision() > marks_.told_revision, marks_.told_at + kMarksPause);
  wait_for(scene_revision_ > scene_.told_revision, scene_.told_at + kScenePause);
  wait_for(!rays_.empty() || board_.pointers_revision() > pointers_.told_revision,
           pointers_.told_at + kPointersPause);
  if (const auto deadline = roster_.NextDeadline(); deadline.has_value()) wait_for(true, *deadline);
  const auto members = told ? Members() : std::vector<std::shared_ptr<delivery::Viewer>>();
  lock.unlock();
  for (const auto& member : members) member->Wake();
  for (const auto& member : gone) member->Wake();
  return next;
}

// Takes rays of people in turn, so that many people who point do not delay one another for long.
std::map<std::uint64_t, Ray> Audience::TakeRays() {
  std::map<std::uint64_t, Ray> taken;
  while (!rays_.empty() && taken.size() < kMaxFound) {
    auto next = rays_.upper_bound(last_found_);
    if (next == rays_.end()) next = rays_.begin();
    last_found_ = next->first;
    taken.insert(rays_.extract(next));
  }
  return taken;
}

bool Audience::IsDue(const Subject& subject, std::uint64_t revision,
                     std::chrono::milliseconds pause, Time now) {
  return revision > subject.told_revision &&
         (subject.told.count == 0 || now >= subject.told_at + pause);
}

bool Audience::TellDue(Time now) {
  bool told = false;
  const auto tell = [&](Subject& subject, std::uint64_t revision, std::chrono::milliseconds pause,
                        const auto& format, const auto& value) {
    if (!IsDue(subject, revision, pause, now)) return;
    subject = {{subject.told.count + 1, std::make_shared<const std::string>(format(value))},
               revision,
               now};
    told = true;
  };
  tell(presence_, roster_.revision(), kPresencePause, format_.presence, roster_);
  tell(pointers_, board_.pointers_revision(), kPointersPause, format_.pointers, board_.pointers());
  if (IsDue(marks_, board_.marks_revision(), kMarksPause, now)) {
    TellMarks(now);
    told = true;
  }
  tell(held_times_, held_revision_, kAtOnce, format_.held_times, held_);
  tell(
      scene_, scene_revision_, kScenePause, [](std::uint64_t) { return std::string(); },
      scene_revision_);
  return told;
}

void Audience::Settle(std::unique_lock<std::mutex> lock, Time now) {
  const bool told = TellDue(now);
  const bool due =
      !rays_.empty() || roster_.revision() > presence_.told_revision ||
      board_.marks_revision() > marks_.told_revision || scene_revision_ > scene_.told_revision ||
      board_.pointers_revision() > pointers_.told_revision || roster_.NextDeadline().has_value();
  const auto members = told ? Members() : std::vector<std::shared_ptr<delivery::Viewer>>();
  lock.unlock();
  for (const auto& member : members) member->Wake();
  if (due) on_due_();
}

std::vector<std::shared_ptr<delivery::Viewer>> Audience::Members() const {
  std::vector<std::shared_ptr<delivery::Viewer>> members;
  for (const auto& [id, member] : members_) members.push_back(member.viewer);
  return members;
}

}  // namespace thunderhead::session
