// A thread that may hang in a system call that nobody can end, as on a storage that has gone: it is
// left behind then, so what it runs must own all that it uses.
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

  // How long an owner waits for the end of a thread that it has told to end.
  static constexpr std::chrono::seconds kPatience{5};

  LooseThread() = default;
  // The thread's end is waited for by `time`, which must outlive this.
  LooseThread(std::string name, std::function<void()> run, const TimeSource& time = SteadyTime());
  // Waits kPatience for its end; its owner must have told it to end before.
  ~LooseThread();
  LooseThread(LooseThread&&) noexcept = default;
  LooseThread& operator=(LooseThread&&) = delete;

  // Waits until it ends or until `deadline`; true if it has ended.
  bool EndsBy(Time deadline) const;
  bool HasEnded() const;

  // Throws what it threw, once it has ended.
  void Rethrow() const { ended_.get(); }

  // It has been waited for already: it is joined if it has ended, and left behind if not.
  void LetGo() { LetGoBy(Time::min()); }
  // Waits for its end until `deadline`, after which it is left behind.
  void LetGoBy(Time deadline);

  // True if one was left behind in this process: it must end by _exit, as the thread may wake up
  // while what it uses is being destroyed.
  static bool AnyLeftBehind();

 private:
  const TimeSource* time_ = &SteadyTime();
  std::string name_;
  std::shared_future<void> ended_;
  std::thread thread_;
};

}  // namespace thunderhead::base
