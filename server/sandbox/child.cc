#include "sandbox/child.h"

#include <sys/wait.h>

#include <csignal>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/timed_calls.h"

namespace thunderhead::sandbox {
namespace {

using std::chrono::milliseconds;

// The places of this program's children.
class Places {
 public:
  absl::Status Take() {
    const std::lock_guard lock(mutex_);
    Collect();
    if (!abandoned_.empty() && abandoned_.size() + running_ >= kMaxAbandonedChildren) {
      return base::WithDetails(
          absl::UnavailableError(absl::StrCat(
              "no process can be started to read it, because ", abandoned_.size(),
              " earlier ones cannot be ended; check whether the storage of the data folders "
              "answers, and try again")),
          {.reason = base::kStorageHangs});
    }
    ++running_;
    return absl::OkStatus();
  }

  void Return() {
    const std::lock_guard lock(mutex_);
    --running_;
    Collect();
  }

  void Abandon(pid_t process) {
    const std::lock_guard lock(mutex_);
    --running_;
    abandoned_.push_back(process);
  }

  std::size_t Abandoned() {
    const std::lock_guard lock(mutex_);
    Collect();
    return abandoned_.size();
  }

 private:
  void Collect() {
    std::erase_if(abandoned_, [](pid_t each) { return waitpid(each, nullptr, WNOHANG) != 0; });
  }

  std::mutex mutex_;
  std::size_t running_ = 0;
  std::vector<pid_t> abandoned_;
};

Places& OfProgram() {
  // Never destroyed, because threads may still end children while static objects are destroyed.
  static auto* const places = new Places;
  return *places;
}

}  // namespace

std::size_t AbandonedChildren() { return OfProgram().Abandoned(); }

absl::StatusOr<ChildPlace> ChildPlace::Take() {
  if (absl::Status taken = OfProgram().Take(); !taken.ok()) return taken;
  return ChildPlace();
}

ChildPlace::~ChildPlace() {
  if (taken_) OfProgram().Return();
}

void ChildPlace::LeaveTo(pid_t process) {
  if (std::exchange(taken_, false)) OfProgram().Abandon(process);
}

void KillProcess(pid_t process) { kill(process, SIGKILL); }

Child::~Child() {
  if (process_ <= 0) return;
  kill_process_(process_);
  if (!End(milliseconds(2)).has_value()) place_.LeaveTo(process_);
}

std::optional<int> Child::End(milliseconds patience) {
  const auto until = time_.Now() + patience;
  int status = 0;
  while (process_ > 0) {
    const pid_t ended = waitpid(process_, &status, WNOHANG);
    if (ended != 0) {
      process_ = 0;
      return ended > 0 && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    }
    if (time_.Now() >= until) return std::nullopt;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return 0;
}

}  // namespace thunderhead::sandbox
