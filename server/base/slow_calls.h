// Says which files and folders are being waited for where that takes long: a call to a storage that
// hangs does not return, and its caller can say nothing any more. Bounds no call (patient_calls.h
// does).
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

  // Says, from a thread of its own, of each call that takes longer than `patience`, again each time
  // that it has taken twice as long, and once it returns. `time` must outlive this.
  SlowCalls(std::chrono::milliseconds patience, std::function<void(const std::string&)> say,
            const TimeSource& time = SteadyTime());
  // Must outlive its calls.
  ~SlowCalls() = default;
  SlowCalls(const SlowCalls&) = delete;
  SlowCalls& operator=(const SlowCalls&) = delete;

  // The process's, which writes to the log after 10 s.
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

// A call to the storage of `path`, under way while this lives.
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
