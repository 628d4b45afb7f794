#include "store/timed_stores.h"

#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/slow_calls.h"
#include "base/status.h"

namespace thunderhead::store {
namespace {

using jobs::JobChange;
using jobs::JobRecord;
using session::SessionRecord;

// Keeps an object until the process ends. It is used for a store whose storage hangs, because
// closing the store would hang, too.
void KeepForEver(std::shared_ptr<const void> object) {
  static std::mutex mutex;
  static auto& kept = *new std::vector<std::shared_ptr<const void>>;
  const std::lock_guard lock(mutex);
  kept.push_back(std::move(object));
}

template <typename Store>
class Patient {
 public:
  Patient(std::shared_ptr<Store> store, std::shared_ptr<base::TimedCalls> calls, std::string folder)
      : store_(std::move(store)), calls_(std::move(calls)), folder_(std::move(folder)) {}
  Patient(const Patient&) = delete;
  Patient& operator=(const Patient&) = delete;

  ~Patient() {
    const auto held = std::make_shared<std::shared_ptr<Store>>(std::move(store_));
    const absl::Status closed = calls_->Run(folder_, [held, folder = folder_] {
      const base::SlowCall slow(folder);
      held->reset();
    });
    if (!closed.ok()) KeepForEver(held);
  }

  // `call` must own everything that it uses except the store.
  template <typename Call>
  absl::Status Do(Call call) const {
    absl::Status done = calls_->Ask(folder_, [store = store_, folder = folder_, call] {
      const base::SlowCall slow(folder);
      return call(*store);
    });
    if (!absl::IsDeadlineExceeded(done)) return done;
    return base::WithDetails(
        absl::UnavailableError(absl::StrCat("the state folder ", folder_, " does not answer")),
        base::DetailsOf(done));
  }

  auto Load() const {
    const base::SlowCall slow(folder_);
    return store_->Load();
  }

 private:
  std::shared_ptr<Store> store_;
  const std::shared_ptr<base::TimedCalls> calls_;
  const std::string folder_;
};

class TimedSessionStore final : public session::SessionStore {
 public:
  explicit TimedSessionStore(auto... parts) : store_(std::move(parts)...) {}

  absl::Status Save(const std::vector<SessionRecord>& records) override {
    return store_.Do([records](SessionStore& store) { return store.Save(records); });
  }
  absl::Status Remove(const std::vector<std::string>& ids) override {
    return store_.Do([ids](SessionStore& store) { return store.Remove(ids); });
  }
  absl::Status Check() override {
    return store_.Do([](SessionStore& store) { return store.Check(); });
  }
  absl::StatusOr<std::vector<SessionRecord>> Load() override { return store_.Load(); }

 private:
  const Patient<SessionStore> store_;
};

class TimedJobStore final : public jobs::JobStore {
 public:
  explicit TimedJobStore(auto... parts) : store_(std::move(parts)...) {}

  absl::Status Add(const JobRecord& job) override {
    return store_.Do([job](JobStore& store) { return store.Add(job); });
  }
  absl::Status Save(const std::vector<JobChange>& changes) override {
    return store_.Do([changes](JobStore& store) { return store.Save(changes); });
  }
  absl::Status Remove(const std::vector<std::string>& ids) override {
    return store_.Do([ids](JobStore& store) { return store.Remove(ids); });
  }
  absl::StatusOr<std::vector<JobRecord>> Load() override { return store_.Load(); }

 private:
  const Patient<JobStore> store_;
};

}  // namespace

std::shared_ptr<session::SessionStore> WithPatience(std::shared_ptr<session::SessionStore> store,
                                                    std::shared_ptr<base::TimedCalls> calls,
                                                    const std::string& folder) {
  return std::make_shared<TimedSessionStore>(std::move(store), std::move(calls), folder);
}

std::shared_ptr<jobs::JobStore> WithPatience(std::shared_ptr<jobs::JobStore> store,
                                             std::shared_ptr<base::TimedCalls> calls,
                                             const std::string& folder) {
  return std::make_shared<TimedJobStore>(std::move(store), std::move(calls), folder);
}

}  // namespace thunderhead::store
