#include "session/sessions.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/random_hex.h"
#include "base/status.h"
#include "base/utf8.h"

namespace thunderhead::session {
namespace {

// A session key is a secret of 128 bits.
constexpr int kKeyWords = 4;  // number of words of 32 bits
constexpr int kIdWords = 2;

// The number of revisions that a restored session skips. It is larger than the number of revisions
// by which a session can be ahead of its record. So a restored session never gives two scenes the
// same revision.
constexpr std::uint64_t kUnsavedRevisions = 1'000'000;

// Sessions that are no longer used expire one after another, so there may soon be room for a new
// one.
constexpr std::chrono::seconds kSessionRetryAfter{30};

absl::Status Gone(const std::string& message, const std::string& reason = "SESSION_NOT_FOUND") {
  return base::WithDetails(absl::NotFoundError(message), {.reason = reason});
}

// The key in the error may be a secret with one mistyped character, so the error prints only its
// first four characters.
absl::Status NotFound(const std::string& key) {
  constexpr std::size_t kPrinted = 4;
  const std::string begin = key.size() > kPrinted ? key.substr(0, kPrinted) + "..." : key;
  return Gone(absl::StrCat("no session has the key '", base::Printable(begin),
                           "': it was closed or has expired; create a new one"));
}

absl::Status TooManySessions(const char* who, std::size_t max_sessions) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(who, " the maximum of ", max_sessions,
                                                " sessions; close one, or try again later")),
      {.reason = "TOO_MANY_SESSIONS",
       .metadata = {{"maximum", absl::StrCat(max_sessions)}, {"unit", "sessions"}},
       .retry_after = kSessionRetryAfter});
}

}  // namespace

Session::Session(std::string id, SessionKeys keys, const Rules& rules, Board board,
                 const AudienceFormat& format, const SessionSignals& signals,
                 const RosterTimeouts& timeouts, std::string owner, const base::TimeSource& time)
    : id_(std::move(id)),
      keys_(std::move(keys)),
      owner_(std::move(owner)),
      signals_(signals),
      time_(time),
      hub_(signals.on_work, signals.on_due, time),
      audience_(format, rules, std::move(board), time.Now(), signals.on_due, timeouts) {}

std::uint64_t Session::TakeRevision(IncompleteUpdate update) {
  const std::lock_guard lock(mutex_);
  taken_.emplace(++revision_count_, std::move(update));
  return revision_count_;
}

void Session::DropOverruled() {
  std::map<std::uint64_t, IncompleteUpdate> taken;
  {
    const std::lock_guard lock(mutex_);
    taken = taken_;
  }
  // Runs without the lock because still_counts asks the roster, which has its own lock.
  for (const auto& [revision, update] : taken) {
    if (update.still_counts != nullptr && !update.still_counts()) Drop(revision);
  }
}

absl::StatusOr<std::uint64_t> Session::TakeRevisionAfter(std::uint64_t expected,
                                                         IncompleteUpdate update) {
  DropOverruled();
  const std::lock_guard lock(mutex_);
  std::uint64_t newest = newest_.has_value() ? newest_->revision : 0;
  if (!taken_.empty()) newest = std::max(newest, taken_.rbegin()->first);
  if (newest != expected) {
    return base::WithDetails(
        absl::AbortedError(
            absl::StrCat("the scene is at revision ", newest, ", not ", expected,
                         ": another person changed it; make the change to the newest scene")),
        {.reason = "REVISION_CHANGED", .metadata = {{"revision", absl::StrCat(newest)}}});
  }
  taken_.emplace(++revision_count_, std::move(update));
  return revision_count_;
}

std::optional<SerializedScene> Session::NewestTaken() {
  DropOverruled();
  const std::lock_guard lock(mutex_);
  if (!taken_.empty() && !taken_.rbegin()->second.serialized.empty()) {
    const auto& [revision, update] = *taken_.rbegin();
    if (!newest_.has_value() || revision > newest_->revision) {
      return SerializedScene{revision, update.serialized};
    }
  }
  if (!newest_.has_value()) return std::nullopt;
  return SerializedScene{newest_->revision, *newest_->serialized};
}

void Session::Drop(std::uint64_t revision) {
  const std::lock_guard lock(mutex_);
  taken_.erase(revision);
}

bool Session::Show(std::uint64_t revision, scene::Scene scene, std::string serialized,
                   const std::optional<std::string>& domain) {
  std::vector<std::shared_ptr<OwnView>> views;
  NewestScene newest;
  {
    const std::lock_guard lock(mutex_);
    if (taken_.erase(revision) == 0) return false;
    if (newest_.has_value() && newest_->revision > revision) return true;
    const Clock::time_point now = Now();
    newest_ = {.revision = revision,
               .scene = std::make_shared<const scene::Scene>(std::move(scene)),
               .changed_at = now,
               .usual_pause = rhythm_.Changed(now),
               .serialized = std::make_shared<const std::string>(std::move(serialized))};
    newest = *newest_;
    std::erase_if(own_views_, [](const auto& view) { return view.expired(); });
    for (const auto& view : own_views_) views.push_back(view.lock());
  }
  for (const auto& view : views) {
    if (view != nullptr) view->Follow(newest);
  }
  audience_.SceneChanged(newest.revision, domain, Now());
  signals_.on_work();
  return true;
}

void Session::ShowRestored(const SessionRecord& record, scene::Scene scene, std::string serialized,
                           const std::optional<std::string>& domain) {
  audience_.RestoreControl(record.control, Now());
  {
    const std::lock_guard lock(mutex_);
    revision_count_ = record.scene_revision + kUnsavedRevisions - 1;
    last_used_ = Now();
  }
  Show(TakeRevision(), std::move(scene), std::move(serialized), domain);
}

void Session::Close(const absl::Status& why) {
  hub_.Close(why);
  audience_.WakeAll();
}

bool Session::HasEnded() const { return absl::IsNotFound(hub_.ClosedBecause()); }

std::optional<NewestScene> Session::Newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void Session::Touch() {
  const std::lock_guard lock(mutex_);
  last_used_ = Now();
}

Clock::time_point Session::last_used() const {
  const std::lock_guard lock(mutex_);
  return last_used_;
}

bool Session::IsWatched() const { return hub_.HasViewers() || !audience_.Empty(); }

Clock::time_point Session::UsedUntil() const { return IsWatched() ? Now() : last_used(); }

SessionVersion Session::Version() const {
  const std::optional<NewestScene> newest = Newest();
  return {newest.has_value() ? newest->revision : 0, audience_.MarksRevision(),
          audience_.CurrentRules(), audience_.ControlToKeep()};
}

SessionRecord Session::Record() const {
  SessionRecord record{.id = id_,
                       .keys = keys_,
                       .owner = owner_,
                       .rules = audience_.CurrentRules(),
                       .control = audience_.ControlToKeep()};
  if (const std::optional<NewestScene> newest = Newest(); newest.has_value()) {
    record.scene = *newest->serialized;
    record.scene_revision = newest->revision;
  }
  record.marks = audience_.Drawn().marks();
  record.last_used =
      std::chrono::system_clock::now() -
      std::chrono::duration_cast<std::chrono::system_clock::duration>(Now() - UsedUntil());
  return record;
}

std::shared_ptr<OwnView> OwnView::Of(const std::shared_ptr<Session>& session, std::string id,
                                     const scene::Camera& camera, std::string owner) {
  auto drawn = std::make_shared<Session>(std::move(id), SessionKeys{}, Rules{}, Board{},
                                         AudienceFormat{}, session->signals_, RosterTimeouts{},
                                         std::move(owner), session->time_);
  std::shared_ptr<OwnView> view(new OwnView(std::move(drawn)));
  view->camera_ = camera;
  {
    const std::lock_guard lock(session->mutex_);
    std::erase_if(session->own_views_, [](const auto& other) { return other.expired(); });
    session->own_views_.push_back(view);
  }
  // The view is registered with the session before the newest scene is read, so that it misses no
  // scene.
  if (const auto newest = session->Newest(); newest.has_value()) view->Follow(*newest);
  return view;
}

void OwnView::MoveCamera(const scene::Camera& camera) {
  const std::lock_guard lock(mutex_);
  camera_ = camera;
  Show();
}

void OwnView::Follow(const NewestScene& scene) {
  const std::lock_guard lock(mutex_);
  if (scene_.has_value() && scene_->revision > scene.revision) return;
  scene_ = scene;
  Show();
}

void OwnView::Show() {
  if (!scene_.has_value()) return;
  scene::Scene scene = *scene_->scene;
  scene.camera = camera_;
  // Only sessions show the reference. An own view uses the default technique instead.
  if (scene::IsTraced(scene.rendering.technique)) {
    scene.rendering.technique = scene::Rendering().technique;
  }
  drawn_->Show(drawn_->TakeRevision(), std::move(scene));
}

Sessions::Sessions(const SessionsOptions& options, const SessionSignals& signals)
    : options_(options), signals_(signals), roster_timeouts_(options.roster_timeouts) {}

absl::StatusOr<std::shared_ptr<Session>> Sessions::Create(const Rules& rules,
                                                          const std::string& owner) {
  const std::lock_guard lock(mutex_);
  if (!closed_because_.ok()) return closed_because_;
  if (!refuses_new_.ok()) return refuses_new_;
  DropExpired();
  if (sessions_.size() >= options_.max_sessions) {
    return TooManySessions("the server already has", options_.max_sessions);
  }
  const auto owned = std::ranges::count_if(
      sessions_, [&owner](const auto& entry) { return entry.second->owner() == owner; });
  if (!owner.empty() && static_cast<std::size_t>(owned) >= options_.max_sessions_per_owner) {
    return TooManySessions("you already have", options_.max_sessions_per_owner);
  }
  auto session = std::make_shared<Session>(
      base::RandomHex(kIdWords),
      SessionKeys{base::RandomHex(kKeyWords), base::RandomHex(kKeyWords)}, rules, Board{},
      options_.format, signals_, roster_timeouts_, owner, time());
  Add(session);
  return session;
}

std::shared_ptr<Session> Sessions::Restore(const SessionRecord& record, scene::Scene scene,
                                           std::string serialized,
                                           const std::optional<std::string>& domain) {
  std::unique_lock lock(mutex_);
  const RosterTimeouts timeouts = roster_timeouts_;
  lock.unlock();
  auto session =
      std::make_shared<Session>(record.id, record.keys, record.rules, Board(record.marks),
                                options_.format, signals_, timeouts, record.owner, time());
  session->ShowRestored(record, std::move(scene), std::move(serialized), domain);
  lock.lock();
  Add(session);
  return session;
}

bool Sessions::IsTooOld(std::chrono::system_clock::time_point last_used) const {
  return std::chrono::system_clock::now() - last_used > options_.max_absence;
}

void Sessions::Add(const std::shared_ptr<Session>& session) {
  sessions_[session->id()] = session;
  id_by_key_[session->keys().presenter] = session->id();
  id_by_key_[session->keys().viewer] = session->id();
}

absl::StatusOr<Sessions::Map::iterator> Sessions::FindByKey(const std::string& key) {
  if (!closed_because_.ok()) return closed_because_;
  DropExpired();
  const auto id = id_by_key_.find(key);
  if (id == id_by_key_.end()) return NotFound(key);
  return sessions_.find(id->second);
}

absl::StatusOr<FoundSession> Sessions::Find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto found, FindByKey(key));
  const std::shared_ptr<Session>& session = found->second;
  session->Touch();
  return FoundSession{session, key == session->keys().presenter ? Role::kPresenter : Role::kViewer};
}

absl::Status Sessions::Close(const std::string& presenter_key) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    THUNDERHEAD_ASSIGN_OR_RETURN(const auto found, FindByKey(presenter_key));
    if (presenter_key != found->second->keys().presenter) {
      return base::WithDetails(
          absl::PermissionDeniedError(
              "the viewers' key cannot close a session; use the presenter's key"),
          {.reason = "NOT_PRESENTER"});
    }
    session = Remove(found);
  }
  session->Close(Gone("the session was closed", "SESSION_CLOSED"));
  signals_.on_work();
  return absl::OkStatus();
}

std::shared_ptr<Session> Sessions::Remove(Map::iterator at) {
  std::shared_ptr<Session> session = std::move(at->second);
  id_by_key_.erase(session->keys().presenter);
  id_by_key_.erase(session->keys().viewer);
  sessions_.erase(at);
  return session;
}

void Sessions::RefuseNew(const absl::Status& why) {
  Map sessions;
  {
    const std::lock_guard lock(mutex_);
    if (refuses_new_.ok()) refuses_new_ = why;
    sessions = sessions_;
  }
  for (const auto& [id, session] : sessions) session->audience().WakeAll();
}

void Sessions::CloseAll(const absl::Status& why) {
  Map sessions;
  {
    const std::lock_guard lock(mutex_);
    if (closed_because_.ok()) closed_because_ = why;
    sessions.swap(sessions_);
    id_by_key_.clear();
  }
  for (const auto& [id, session] : sessions) session->Close(why);
}

std::shared_ptr<OwnView> Sessions::OpenView(const std::shared_ptr<Session>& session,
                                            const scene::Camera& camera, const std::string& owner) {
  const std::lock_guard lock(mutex_);
  std::string id = absl::StrCat(session->id(), "/", ++view_count_);
  auto view = OwnView::Of(session, id, camera, owner);
  views_[std::move(id)] = view;
  return view;
}

std::vector<std::shared_ptr<Session>> Sessions::All() {
  const std::lock_guard lock(mutex_);
  DropExpired();
  std::vector<std::shared_ptr<Session>> all;
  for (const auto& [id, session] : sessions_) all.push_back(session);
  return all;
}

std::vector<std::shared_ptr<Session>> Sessions::AllDrawn() {
  const std::lock_guard lock(mutex_);
  DropExpired();
  Map all = sessions_;
  std::erase_if(views_, [](const auto& view) { return view.second.expired(); });
  for (const auto& [id, view] : views_) {
    if (const auto held = view.lock(); held != nullptr) all[id] = held->drawn();
  }
  std::vector<std::shared_ptr<Session>> drawn;
  for (const auto& [id, session] : all) drawn.push_back(session);
  return drawn;
}

void Sessions::SetRosterTimeouts(const RosterTimeouts& timeouts) {
  {
    const std::lock_guard lock(mutex_);
    roster_timeouts_ = timeouts;
  }
  for (const auto& session : All()) {
    const absl::Status set = session->audience().Change(
        [&timeouts](Roster& roster) {
          roster.SetTimeouts(timeouts);
          return absl::OkStatus();
        },
        session->Now());
    (void)set;  // the lambda above never fails
  }
}

void Sessions::DropExpired() {
  const Clock::time_point now = time().Now();
  for (auto entry = sessions_.begin(); entry != sessions_.end();) {
    Session& session = *entry->second;
    const auto timeout =
        session.IsWatched() ? options_.watched_idle_timeout : options_.idle_timeout;
    const auto next = std::next(entry);
    if (session.last_used() < now - timeout) {
      const auto expired = Remove(entry);
      // This also ends the stream of a viewer that is joining right now.
      expired->Close(Gone("the session has expired; create a new one", "SESSION_EXPIRED"));
    }
    entry = next;
  }
}

}  // namespace thunderhead::session
