#include "session/roster.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::session {
namespace {

absl::Status Denied(const std::string& message, const std::string& reason) {
  return base::WithDetails(absl::PermissionDeniedError(message), {.reason = reason});
}

absl::Status Locked() { return Denied("control is locked by the presenter", "CONTROL_LOCKED"); }

absl::Status NoSuchPerson(std::uint64_t id) {
  return base::WithDetails(
      absl::NotFoundError(absl::StrCat("viewer_id is ", id, "; no one in the session has this id")),
      {.reason = "VIEWER_NOT_FOUND", .metadata = {{"viewer_id", absl::StrCat(id)}}});
}

// People without a name are called by their number.
std::string NameOf(const Person& person) {
  return person.name.empty() ? absl::StrCat("viewer ", person.id) : person.name;
}

}  // namespace

void Roster::RestoreControl(const KeptControl& kept, Time now) {
  if (kept.is_free) return Free();
  if (kept.viewer_key.empty()) return;
  away_since_.reset();
  count_ = std::max(count_, kept.viewer_id);
  awaited_ = {.left = {.id = kept.viewer_id,
                       .name = kept.viewer_name,
                       .role = Role::kViewer,
                       .key = kept.viewer_key},
              .left_at = now,
              .server_is_new = true};
}

KeptControl Roster::ControlToKeep() const {
  if (control_is_free()) return {.is_free = true};
  const Person* const steers = awaited_.has_value() ? &awaited_->left : Find(steering_);
  if (steers == nullptr || steers->role != Role::kViewer || steers->key.empty()) return {};
  return {.viewer_key = steers->key, .viewer_name = steers->name, .viewer_id = steers->id};
}

std::uint64_t Roster::Join(Role role, std::string name, Time now, std::string key, bool answers) {
  ++revision_;
  std::erase_if(asked_and_left_, [&](const auto& asked) {
    return now >= asked.second.asked_at + std::max(timeouts_.ask_again, timeouts_.answer);
  });
  for (Person& other : people_) {
    if (key.empty() || other.key != key || other.role != role || !other.answers) continue;
    ++other.doubts;
    other.doubted_at = now;
    other.checked_at.reset();
  }
  people_.push_back({.id = ++count_,
                     .name = std::move(name),
                     .role = role,
                     .key = std::move(key),
                     .answers = answers});
  Person& person = people_.back();
  if (const auto asked = asked_and_left_.find({role, person.key}); asked != asked_and_left_.end()) {
    person.asked_at = asked->second.asked_at;
    person.asks = asked->second.is_open && now < asked->second.asked_at + timeouts_.answer;
    asked_and_left_.erase(asked);
  }
  const bool is_awaited =
      awaited_.has_value() && awaited_->left.key == person.key && awaited_->left.role == role;
  const bool is_kept = away_since_.has_value();
  const bool is_given = person.asks && GivesToWhoAsks();
  if (is_awaited || is_given || (is_kept && role == Role::kPresenter)) Give(person);
  return count_;
}

void Roster::Leave(std::uint64_t id, Time now) {
  const auto leaves = std::ranges::find(people_, id, &Person::id);
  if (leaves == people_.end()) return;
  const Person left = std::move(*leaves);
  people_.erase(leaves);
  ++revision_;
  Person* const heir = FindByKey(left.role, left.key);
  if (left.asked_at.has_value() && heir != nullptr) {
    heir->asked_at = std::max(heir->asked_at.value_or(*left.asked_at), *left.asked_at);
    heir->asks = heir->asks || (left.asks && heir->id != steering_);
  } else if (left.asked_at.has_value() && !left.key.empty()) {
    asked_and_left_[{left.role, left.key}] = {*left.asked_at, left.asks};
  }
  if (steering_ != id) return;
  if (heir != nullptr) return Give(*heir);
  if (left.key.empty()) return GiveBack(now);
  steering_ = 0;
  awaited_ = {.left = left, .left_at = now};
}

void Roster::Heard(std::uint64_t id) {
  if (Person* const person = FindPerson(id); person != nullptr) person->doubted_at.reset();
}

void Roster::Checked(std::uint64_t id, std::uint64_t doubts, Time now) {
  Person* const person = FindPerson(id);
  if (person != nullptr && person->doubts == doubts) person->checked_at = now;
}

bool Roster::presenter_away() const {
  if (away_since_.has_value()) return true;
  return awaited_.has_value() && awaited_->left.role == Role::kPresenter &&
         std::ranges::find(people_, Role::kPresenter, &Person::role) == people_.end();
}

bool Roster::Has(Role role, const std::string& key) const {
  return !key.empty() && std::ranges::any_of(people_, [&](const Person& person) {
    return person.role == role && person.key == key;
  });
}

void Roster::Rename(std::uint64_t id, std::string name) {
  Person* const person = FindPerson(id);
  if (person == nullptr) return;
  person->name = std::move(name);
  ++revision_;
}

void Roster::SetHidden(std::uint64_t id, bool hidden) {
  Person* const person = FindPerson(id);
  if (person == nullptr || person->hidden == hidden) return;
  person->hidden = hidden;
  ++revision_;
}

absl::Status Roster::MaySteer(std::uint64_t id) const {
  if (steering_ == id && id != 0) return absl::OkStatus();
  const Person* const other = Find(steering_);
  return Denied(other != nullptr
                    ? absl::StrCat(NameOf(*other), " is in control; ask for control first")
                    : "you are not in control; ask for control first",
                "NOT_STEERING");
}

absl::Status Roster::PresenterMaySteer() const {
  const Person* const other = Find(steering_);
  if (other == nullptr || other->role == Role::kPresenter) return absl::OkStatus();
  return Denied(
      absl::StrCat(NameOf(*other), " is in control; take control back first, with Interact"),
      "NOT_STEERING");
}

absl::Status Roster::AskControl(std::uint64_t id, Time now) {
  Person* const person = FindPerson(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (steering_ == id) return absl::OkStatus();
  if (person->role == Role::kPresenter) return TakeControl(id);
  if (rules_.control_locked) return Locked();
  if (GivesToWhoAsks()) {
    Give(*person);
    return absl::OkStatus();
  }
  const Time asked_at = person->asked_at.value_or(Time::min());
  if (person->asked_at.has_value() && now < asked_at + timeouts_.ask_again) {
    return base::WithDetails(
        absl::ResourceExhaustedError("you asked for control a moment ago; wait a few seconds"),
        {.reason = "ASKED_TOO_OFTEN",
         .retry_after = std::chrono::duration_cast<std::chrono::milliseconds>(
             asked_at + timeouts_.ask_again - now)});
  }
  person->asked_at = now;
  person->asks = true;
  ++revision_;
  return absl::OkStatus();
}

absl::Status Roster::MayAnswer(std::uint64_t id) const {
  const Person* const person = Find(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (steering_ == id || person->role == Role::kPresenter) return absl::OkStatus();
  return Denied("only a presenter or the person in control can give or refuse control",
                "NOT_STEERING");
}

absl::Status Roster::GiveControl(std::uint64_t from, std::uint64_t to, Time now) {
  if (absl::Status may = MayAnswer(from); !may.ok()) return may;
  if (to != 0) {
    Person* const person = FindPerson(to);
    if (person == nullptr) return NoSuchPerson(to);
    const bool by_viewer = Find(from)->role == Role::kViewer;
    if (rules_.control_locked && by_viewer && person->role == Role::kViewer) return Locked();
    Give(*person);
    return absl::OkStatus();
  }
  ++revision_;
  if (Find(from)->role == Role::kPresenter) {
    Free();
  } else {
    GiveBack(now);
  }
  return absl::OkStatus();
}

absl::Status Roster::RefuseControl(std::uint64_t from, std::uint64_t to) {
  if (absl::Status may = MayAnswer(from); !may.ok()) return may;
  Person* const person = FindPerson(to);
  if (person == nullptr) return NoSuchPerson(to);
  person->asks = false;
  ++revision_;
  return absl::OkStatus();
}

absl::Status Roster::TakeControl(std::uint64_t id) {
  Person* const person = FindPerson(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (person->role != Role::kPresenter) {
    return Denied("only a presenter can take control; ask for it", "NOT_PRESENTER");
  }
  Give(*person);
  return absl::OkStatus();
}

absl::Status Roster::SetRules(std::uint64_t id, const Rules& rules) {
  const Person* const person = Find(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (person->role != Role::kPresenter) {
    return Denied("only a presenter can set rules", "NOT_PRESENTER");
  }
  rules_ = rules;
  ++revision_;
  for (auto& [who, request] : asked_and_left_) {
    if (rules_.control_locked) request.is_open = false;
  }
  for (Person& other : people_) {
    if (rules_.control_locked) other.asks = false;
    if (rules_.following_locked && other.role == Role::kViewer) ReturnToView(other);
  }
  return absl::OkStatus();
}

absl::StatusOr<bool> Roster::Detach(std::uint64_t id, std::uint64_t returns) {
  Person* const person = FindPerson(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (rules_.following_locked && person->role == Role::kViewer) {
    return Denied("the presenter has locked the session to one view", "FOLLOWING_LOCKED");
  }
  if (person->returns != returns) return false;
  person->follows = false;
  ++revision_;
  return true;
}

absl::Status Roster::Follow(std::uint64_t id) {
  Person* const person = FindPerson(id);
  if (person == nullptr) return NoSuchPerson(id);
  ReturnToView(*person);
  ++revision_;
  return absl::OkStatus();
}

absl::Status Roster::MayMark(std::uint64_t id) const {
  const Person* const person = Find(id);
  if (person == nullptr) return NoSuchPerson(id);
  if (person->role == Role::kPresenter || rules_.viewers_may_mark || steering_ == id) {
    return absl::OkStatus();
  }
  return Denied("the presenter has not allowed viewers to point and draw", "MARKS_LOCKED");
}

std::vector<std::uint64_t> Roster::Advance(Time now) {
  for (Person& person : people_) {
    if (!person.asks || now < *person.asked_at + timeouts_.answer) continue;
    person.asks = false;
    ++revision_;
  }
  std::vector<std::uint64_t> silent;
  for (const Person& person : people_) {
    if (person.doubted_at.has_value() && now >= DoubtEnds(person)) silent.push_back(person.id);
  }
  for (const std::uint64_t id : silent) Leave(id, now);
  if (awaited_.has_value() && now >= WaitEnds(*awaited_)) {
    GiveBack(awaited_->left_at);
    ++revision_;
  }
  if (FreesWhenAway() && now >= *away_since_ + timeouts_.away) {
    Free();
    ++revision_;
  }
  return silent;
}

bool Roster::GivesToWhoAsks() const {
  return control_is_free() && rules_.viewers_may_steer && !rules_.control_locked;
}

bool Roster::FreesWhenAway() const { return away_since_.has_value() && rules_.free_when_away; }

Roster::Time Roster::DoubtEnds(const Person& person) const {
  const Time at_last = *person.doubted_at + timeouts_.sign_of_life_in_all;
  if (!person.checked_at.has_value()) return at_last;
  return std::min(at_last, *person.checked_at + timeouts_.sign_of_life);
}

Roster::Time Roster::WaitEnds(const Awaited& awaited) const {
  return awaited.left_at +
         (awaited.server_is_new ? timeouts_.come_back_to_new_server : timeouts_.come_back);
}

std::optional<Roster::Time> Roster::NextDeadline() const {
  std::optional<Time> next;
  const auto wait_for = [&](Time time) { next = std::min(next.value_or(time), time); };
  if (FreesWhenAway()) wait_for(*away_since_ + timeouts_.away);
  if (awaited_.has_value()) wait_for(WaitEnds(*awaited_));
  for (const Person& person : people_) {
    if (person.asks) wait_for(*person.asked_at + timeouts_.answer);
    if (person.doubted_at.has_value()) wait_for(DoubtEnds(person));
  }
  return next;
}

const Person* Roster::Find(std::uint64_t id) const {
  const auto at = std::ranges::find(people_, id, &Person::id);
  return at == people_.end() ? nullptr : &*at;
}

Person* Roster::FindPerson(std::uint64_t id) {
  const auto at = std::ranges::find(people_, id, &Person::id);
  return at == people_.end() ? nullptr : &*at;
}

Person* Roster::FindByKey(Role role, const std::string& key) {
  if (key.empty()) return nullptr;
  const auto last = std::find_if(people_.rbegin(), people_.rend(), [&](const Person& person) {
    return person.role == role && person.key == key;
  });
  return last == people_.rend() ? nullptr : &*last;
}

void Roster::Give(Person& to) {
  ++revision_;
  steering_ = to.id;
  away_since_.reset();
  awaited_.reset();
  // The person in control must see the session's view, which they steer.
  ReturnToView(to);
  to.asks = false;
}

void Roster::ReturnToView(Person& person) {
  person.follows = true;
  ++person.returns;
}

void Roster::Free() {
  steering_ = 0;
  away_since_.reset();
  awaited_.reset();
  if (!rules_.viewers_may_steer) return;
  Person* first = nullptr;
  for (Person& person : people_) {
    if (person.asks && (first == nullptr || *person.asked_at < *first->asked_at)) first = &person;
  }
  if (first != nullptr) Give(*first);
}

void Roster::GiveBack(Time since) {
  const auto presenter = std::ranges::find(people_, Role::kPresenter, &Person::role);
  if (presenter != people_.end()) return Give(*presenter);
  steering_ = 0;
  away_since_ = since;
  awaited_.reset();
}

}  // namespace thunderhead::session
