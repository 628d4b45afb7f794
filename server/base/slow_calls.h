// Reports file system calls that take long, with their file or folder. A call to a storage that
// hangs does not return, so the calling thread cannot report the delay itself. This class only
// reports; timed_calls.h adds timeouts.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "base/time_source.h"

namespace thunderhead::base {

class SlowCalls {
 public:
  using Clock = TimeSource::Clock;

  // Creates an object that reports each call that takes longer than `patience`. It passes each
  // report to `say`, on a separate thread. A call is reported again each time its duration has
  // doubled, and when it returns. `time` must outlive this object.
  SlowCalls(std::chrono::milliseconds patience, std::function<void(const std::string&)> say,
            const TimeSource& time = SteadyTime());
  // The object must outlive its calls.
  ~SlowCalls() = default;
  SlowCalls(const SlowCalls&) = delete;
  SlowCalls& operator=(const SlowCalls&) = delete;

  // Returns the instance that the whole process shares. It logs calls that take longer than 10 s.
  static SlowCalls& OfProcess();

 private:
  friend class SlowCall;

  struct Begun {
    std::string path;
    Clock::time_point at;
    std::chrono::milliseconds say_after;
  };

  std::list<Begun>::iterator Begin(std::string path);
  void End(std::list<Begun>::iterator call);
  void Watch(const std::stop_token& stop);

  const std::chrono::milliseconds patience_;
  const std::function<void(const std::string&)> say_;
  const TimeSource& time_;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::list<Begun> calls_;
  std::jthread thread_;
};

// Marks a call to the storage of `path` as in progress while this object lives, so that SlowCalls
// can report it.
class SlowCall {
 public:
  explicit SlowCall(std::string path, SlowCalls& watch = SlowCalls::OfProcess())
      : watch_(watch), call_(watch.Begin(std::move(path))) {}
  ~SlowCall() { watch_.End(call_); }
  SlowCall(const SlowCall&) = delete;
  SlowCall& operator=(const SlowCall&) = delete;

 private:
  SlowCalls& watch_;
  const std::list<SlowCalls::Begun>::iterator call_;
};

}  // namespace thunderhead::base
