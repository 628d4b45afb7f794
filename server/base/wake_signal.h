// Wakes one thread that waits for work. A notification that arrives while the thread is busy is
// kept until the thread waits again, so no notification is lost. Several notifications are merged
// into one.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "base/time_source.h"

namespace thunderhead::base {

class WakeSignal {
 public:
  void Notify() {
    {
      const std::lock_guard lock(mutex_);
      notified_ = true;
    }
    changed_.notify_one();
  }

  // Waits for a notification, or until `deadline` has passed by `time`. Without a deadline, waits
  // for a notification only.
  void Wait(const std::optional<std::chrono::steady_clock::time_point>& deadline,
            const TimeSource& time = SteadyTime()) {
    std::unique_lock lock(mutex_);
    if (deadline.has_value()) {
      WaitUntil(time, changed_, lock, *deadline, [this] { return notified_; });
    } else {
      changed_.wait(lock, [this] { return notified_; });
    }
    notified_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool notified_ = false;
};

}  // namespace thunderhead::base
