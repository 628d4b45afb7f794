// A progress bar for work that takes more than a second. It is shown on standard error if that is a
// terminal. A separate thread draws it, so that it also moves while the work reports nothing.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "base/utf8.h"

namespace thunderhead::runs {

class ProgressBar {
 public:
  // `label` names the work, for example "reading supercell".
  explicit ProgressBar(const std::string& label);
  // Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Sets the share of the work that is done, 0 to 1. Until the first call, the bar only shows
  // activity. Safe to call from any thread.
  void Set(double share) { share_ = share; }

  // Sets the text that follows the share, for example the current error. Safe to call from any
  // thread.
  void Note(const std::string& note) {
    const std::lock_guard lock(mutex_);
    note_ = base::Printable(note);
  }

 private:
  void Draw();

  const std::string label_;
  std::atomic<double> share_{-1.0};
  std::mutex mutex_;
  std::condition_variable ended_changed_;
  bool ended_ = false;
  std::string note_;
  std::thread thread_;
};

}  // namespace thunderhead::runs
