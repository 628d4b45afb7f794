#include "session/sessions.h"

#include <chrono>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/error_details.h"

namespace thunderhead::session {
namespace {

// 128 random bits of the operating system: a client that knows an id may control the session, so
// ids must not be guessable.
std::string RandomId() {
  std::random_device device;
  std::string id;
  for (int word = 0; word < 4; ++word) absl::StrAppendFormat(&id, "%08x", device());
  return id;
}

// Abandoned sessions expire one after another.
constexpr std::chrono::seconds kRetryAfter{30};

absl::Status Gone(const std::string& message) {
  return base::WithDetails(absl::NotFoundError(message), {.reason = "SESSION_NOT_FOUND"});
}

absl::Status NotFound(const std::string& id) {
  return Gone(absl::StrCat("no session has the id '", id,
                           "': it was closed or has expired; create a new one"));
}

absl::Status TooMany(std::size_t max_sessions) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server already has the maximum of ",
                                                max_sessions,
                                                " sessions; close one, or try again later")),
      {.reason = "TOO_MANY_SESSIONS",
       .metadata = {{"maximum", absl::StrCat(max_sessions)}, {"unit", "sessions"}},
       .retry_after = kRetryAfter});
}

}  // namespace

Session::Session(std::string id, std::function<void()> on_work)
    : id_(std::move(id)), on_work_(on_work), hub_(std::move(on_work)) {}

std::uint64_t Session::TakeRevision() {
  const std::lock_guard lock(mutex_);
  return ++revision_count_;
}

void Session::Show(std::uint64_t revision, scene::Scene scene, std::string serialized) {
  {
    const std::lock_guard lock(mutex_);
    if (newest_.has_value() && newest_->revision > revision) return;
    newest_ = {revision, std::make_shared<const scene::Scene>(std::move(scene)), Clock::now(),
               std::make_shared<const std::string>(std::move(serialized))};
  }
  on_work_();
}

std::optional<NewestScene> Session::Newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void Session::Touch() {
  const std::lock_guard lock(mutex_);
  last_used_ = Clock::now();
}

Clock::time_point Session::last_used() const {
  const std::lock_guard lock(mutex_);
  return last_used_;
}

Sessions::Sessions(const SessionsOptions& options, std::function<void()> on_work)
    : options_(options), on_work_(std::move(on_work)) {}

absl::StatusOr<std::shared_ptr<Session>> Sessions::Create() {
  const std::lock_guard lock(mutex_);
  if (!closed_because_.ok()) return closed_because_;
  DropExpired();
  if (sessions_.size() >= options_.max_sessions) {
    return TooMany(options_.max_sessions);
  }
  auto session = std::make_shared<Session>(RandomId(), on_work_);
  sessions_[session->id()] = session;
  return session;
}

absl::StatusOr<std::shared_ptr<Session>> Sessions::Find(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (!closed_because_.ok()) return closed_because_;
  DropExpired();
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return NotFound(id);
  found->second->Touch();
  return found->second;
}

absl::Status Sessions::Close(const std::string& id) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    DropExpired();
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return NotFound(id);
    session = std::move(found->second);
    sessions_.erase(found);
  }
  session->hub().Close(Gone("the session was closed"));
  on_work_();
  return absl::OkStatus();
}

void Sessions::CloseAll(const absl::Status& why) {
  std::map<std::string, std::shared_ptr<Session>> sessions;
  {
    const std::lock_guard lock(mutex_);
    if (closed_because_.ok()) closed_because_ = why;
    sessions.swap(sessions_);
  }
  for (const auto& [id, session] : sessions) session->hub().Close(why);
}

std::vector<std::shared_ptr<Session>> Sessions::All() {
  const std::lock_guard lock(mutex_);
  DropExpired();
  std::vector<std::shared_ptr<Session>> all;
  for (const auto& [id, session] : sessions_) all.push_back(session);
  return all;
}

void Sessions::DropExpired() {
  const Clock::time_point oldest = Clock::now() - options_.idle_timeout;
  for (auto entry = sessions_.begin(); entry != sessions_.end();) {
    Session& session = *entry->second;
    if (!session.hub().HasViewers() && session.last_used() < oldest) {
      // Also ends the stream of a viewer that is joining right now.
      session.hub().Close(Gone("the session has expired; create a new one"));
      entry = sessions_.erase(entry);
    } else {
      ++entry;
    }
  }
}

}  // namespace thunderhead::session
