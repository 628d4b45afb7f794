// A progress bar on standard error, for what takes more than a second, if that is a terminal. Draws
// from a thread of its own, so that it also moves while the work is silent.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace thunderhead::app {

class ProgressBar {
 public:
  // `label` says what is going on, e.g. "reading supercell".
  explicit ProgressBar(std::string label);
  // Wipes the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // How much is done, 0 to 1; until the first call the bar shows only that work goes on. From any
  // thread.
  void Set(double share) { share_ = share; }

  // What is shown after the share, e.g. an error that falls. From any thread.
  void Note(std::string note) {
    const std::lock_guard lock(mutex_);
    note_ = std::move(note);
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
