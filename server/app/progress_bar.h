// A progress bar on standard error if that is a terminal, for work of more than a second. Draws in
// a thread of its own, so that it also moves while the work reports nothing.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "base/utf8.h"

namespace thunderhead::app {

class ProgressBar {
 public:
  // `label` names the work, e.g. "reading supercell".
  explicit ProgressBar(std::string label);
  // Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Sets the share done, 0 to 1; until the first call the bar only shows activity. From any thread.
  void Set(double share) { share_ = share; }

  // Sets the text after the share, e.g. the current error. From any thread.
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

}  // namespace thunderhead::app
