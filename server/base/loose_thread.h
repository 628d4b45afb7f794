// A thread that may hang in a system call that nothing can interrupt, for example because a storage
// is unreachable. A hanging thread is detached and left running (abandoned). Its function must
// therefore own everything it uses.
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

  // The time for which an owner waits for a thread to end, after it has requested the end.
  static constexpr std::chrono::seconds kPatience{5};

  LooseThread() = default;
  // `time` measures the wait for the thread's end and must outlive this object.
  LooseThread(std::string name, std::function<void()> run, const TimeSource& time = SteadyTime());
  // Waits up to kPatience for the thread to end, and then abandons it. The owner must have
  // requested the end before.
  ~LooseThread();
  LooseThread(LooseThread&&) noexcept = default;
  LooseThread& operator=(LooseThread&&) = delete;

  // Waits until the thread ends or until `deadline`. Returns whether it has ended.
  bool EndsBy(Time deadline) const;
  bool HasEnded() const;

  // Waits for the thread to end. If its function threw an exception, throws it again.
  void Rethrow() const { ended_.get(); }

  // Joins the thread if it has ended, and otherwise abandons it without waiting. It is for owners
  // that have already waited.
  void LetGo() { LetGoBy(Time::min()); }
  // Waits for the thread to end until `deadline`, and then abandons it.
  void LetGoBy(Time deadline);

  // Returns whether this process has abandoned a thread. If so, the process must end by _exit,
  // because the thread may wake up while static objects that it uses are being destroyed.
  static bool AnyLeftBehind();

 private:
  const TimeSource* time_ = &SteadyTime();
  std::string name_;
  std::shared_future<void> ended_;
  std::thread thread_;
};

}  // namespace thunderhead::base
