// A thread that may hang in a system call that nothing can interrupt, for example because its
// storage is gone. A hanging thread is abandoned, so what it runs must own everything it uses.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>

#include "base/time_source.h"

namespace thunderhead::base {

class LooseThread {
 public:
  using Time = TimeSource::Clock::time_point;

  // How long an owner waits for a thread to end after it has told the thread to end.
  static constexpr std::chrono::seconds kPatience{5};

  LooseThread() = default;
  // `time` measures the wait for the thread's end and must outlive this.
  LooseThread(std::string name, std::function<void()> run, const TimeSource& time = SteadyTime());
  // Waits kPatience for the thread to end. The owner must have told it to end before.
  ~LooseThread();
  LooseThread(LooseThread&&) noexcept = default;
  LooseThread& operator=(LooseThread&&) = delete;

  // Waits until the thread ends or until `deadline`. Returns whether it has ended.
  bool EndsBy(Time deadline) const;
  bool HasEnded() const;

  // Rethrows the thread's exception, if there is one. Waits for the thread to end.
  void Rethrow() const { ended_.get(); }

  // Joins the thread if it has ended, and otherwise abandons it. For owners that have already
  // waited.
  void LetGo() { LetGoBy(Time::min()); }
  // Waits for the thread to end until `deadline`, and then abandons it.
  void LetGoBy(Time deadline);

  // Returns whether this process has abandoned a thread. It must then end by _exit, because the
  // thread may wake up while the objects that it uses are being destroyed.
  static bool AnyLeftBehind();

 private:
  const TimeSource* time_ = &SteadyTime();
  std::string name_;
  std::shared_future<void> ended_;
  std::thread thread_;
};

}  // namespace thunderhead::base
