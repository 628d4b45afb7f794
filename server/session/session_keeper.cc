#include "session/session_keeper.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/log.h"
#include "base/status.h"
#include "telemetry/metrics.h"

namespace thunderhead::session {
namespace {

absl::Status FirstError(const SessionKeeper::Outcome& outcome) {
  return outcome.saved.ok() ? outcome.removed : outcome.saved;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SessionKeeper>> SessionKeeper::Start(SessionStore& store,
                                                                    Sessions& sessions,
                                                                    const DecodeScene& decode) {
  std::unique_ptr<SessionKeeper> keeper(new SessionKeeper(store, sessions));
  THUNDERHEAD_RETURN_IF_ERROR(keeper->Restore(decode));
  keeper->thread_ = std::thread([raw = keeper.get()] { raw->Run(); });
  return keeper;
}

SessionKeeper::~SessionKeeper() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void SessionKeeper::SaveThen(Done done) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(done));
  }
  changed_.notify_one();
}

absl::Status SessionKeeper::Restore(const DecodeScene& decode) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<SessionRecord> records, store_.Load());
  std::vector<std::string> too_old;
  for (const SessionRecord& record : records) {
    if (sessions_.IsTooOld(record.last_used)) {
      too_old.push_back(record.id);
      continue;
    }
    absl::StatusOr<DecodedScene> decoded = decode(record.scene);
    if (!decoded.ok()) {
      telemetry::Counted().session_damages.Add();
      base::LogError(base::Annotate(
          decoded.status(),
          absl::StrCat("session ", record.id,
                       " cannot be restored; its record is kept until it is too old")));
      continue;
    }
    kept_[record.id].session = sessions_.Restore(record, std::move(decoded->scene),
                                                 std::move(decoded->serialized), decoded->domain);
  }
  THUNDERHEAD_RETURN_IF_ERROR(store_.Remove(too_old));
  // The new revisions are saved before clients can see them, so that the next restart uses even
  // larger ones.
  return FirstError(SaveChanges());
}

SessionKeeper::Outcome SessionKeeper::SaveChanges() {
  for (const auto& session : sessions_.All()) kept_[session->id()].session = session;
  std::vector<SessionRecord> records;
  std::map<std::string, Kept> saved;
  std::vector<std::string> ended;
  for (const auto& [id, kept] : kept_) {
    if (kept.session->HasEnded()) {
      ended.push_back(id);
      continue;
    }
    // The version is read before the record. So the saved record is at least as new as the version
    // that `kept` remembers.
    const SessionVersion version = kept.session->Version();
    const Clock::time_point use = kept.session->UsedUntil();
    if (version.scene_revision == 0) continue;  // the session is still being created
    if (kept.saved == version && use < kept.saved_use + kUsePause) continue;
    records.push_back(kept.session->Record());
    saved[id] = {kept.session, version, use};
  }
  Outcome outcome;
  if (!ended.empty()) outcome.removed = store_.Remove(ended);
  if (outcome.removed.ok()) {
    for (const std::string& id : ended) kept_.erase(id);
  }
  outcome.saved = records.empty() ? store_.Check() : store_.Save(records);
  if (outcome.saved.ok()) {
    for (auto& [id, kept] : saved) kept_[id] = std::move(kept);
  }
  return outcome;
}

void SessionKeeper::Log(const absl::Status& outcome) {
  if (!outcome.ok()) telemetry::Counted().session_save_failures.Add();
  if (outcome != last_outcome_ && !outcome.ok()) {
    base::LogError(base::Annotate(
        outcome,
        "cannot save sessions, which would be lost if the server ended now; trying again"));
  }
  last_outcome_ = outcome;
}

void SessionKeeper::Run() {
  std::unique_lock lock(mutex_);
  for (bool last = false; !last;) {
    const base::TimeSource& time = sessions_.time();
    base::WaitUntil(time, changed_, lock, time.Now() + kPause,
                    [this] { return stopping_ || !waiting_.empty(); });
    last = stopping_;
    const auto waiting = std::exchange(waiting_, {});
    lock.unlock();
    const Outcome outcome = SaveChanges();
    Log(FirstError(outcome));
    for (const Done& done : waiting) done(outcome);
    lock.lock();
  }
}

}  // namespace thunderhead::session
