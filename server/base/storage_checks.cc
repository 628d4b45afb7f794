#include "base/storage_checks.h"

#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/slow_calls.h"

namespace thunderhead::base {

StorageChecks::StorageChecks(const std::string& path, std::function<void()> look,
                             std::chrono::milliseconds patience,
                             std::optional<std::chrono::milliseconds> pause, const TimeSource& time)
    : patience_(patience),
      shared_(new Shared{.look = std::move(look), .path = path, .pause = pause, .time = time}),
      thread_(
          absl::StrCat("a check of ", path), [shared = shared_] { Run(shared); }, time) {}

StorageChecks::~StorageChecks() {
  bool hangs = false;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->stopping = true;
    hangs = shared_->hangs;
  }
  shared_->changed.notify_all();
  if (hangs) thread_.LetGo();
}

void StorageChecks::LookAgain() {
  std::unique_lock lock(shared_->mutex);
  if (shared_->hangs) return;
  const std::uint64_t asked = ++shared_->asked;
  shared_->changed.notify_all();
  const TimeSource& time = shared_->time;
  const bool done = WaitUntil(time, shared_->changed, lock, time.Now() + patience_,
                              [&] { return shared_->done >= asked; });
  if (!done) shared_->hangs = true;
}

void StorageChecks::Run(const std::shared_ptr<Shared>& shared) {
  std::unique_lock lock(shared->mutex);
  while (true) {
    const auto is_due = [&] { return shared->stopping || shared->asked > shared->done; };
    if (shared->pause.has_value()) {
      WaitUntil(shared->time, shared->changed, lock, shared->time.Now() + *shared->pause, is_due);
    } else {
      shared->changed.wait(lock, is_due);
    }
    if (shared->stopping) return;
    const std::uint64_t asked = shared->asked;
    lock.unlock();
    try {
      const SlowCall slow(shared->path);
      shared->look();
    } catch (const std::bad_alloc&) {
      // The check is skipped, because the next check may have enough memory.
    }
    lock.lock();
    shared->done = asked;
    shared->hangs = false;
    shared->changed.notify_all();
  }
}

}  // namespace thunderhead::base
