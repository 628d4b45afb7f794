// Writes lines on a separate thread, so that a disk that hangs does not block the callers.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "base/loose_thread.h"
#include "base/time_source.h"

namespace thunderhead::base {

class LineWriter {
 public:
  // A function that writes a line. `left_out` is the number of lines that were dropped just before
  // the line. If the last lines were dropped, the function is called once more at the end, with an
  // empty line. If the function throws, the line counts as dropped. The function may hang, so it
  // must own everything it uses.
  using WriteLine = std::function<void(const std::string& line, std::uint64_t left_out)>;

  // Creates a writer that drops new lines while `max_waiting` lines are waiting. `time` must
  // outlive this object.
  LineWriter(std::size_t max_waiting, WriteLine write, const TimeSource& time = SteadyTime());
  // Waits until the waiting lines are written, but no longer than LooseThread::kPatience.
  ~LineWriter();
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  // Queues a line to be written, or drops it if too many lines are waiting. Does not block. Safe
  // from any thread.
  void Write(std::string line);
  // Waits up to `time` until all waiting lines are written. Returns whether they are.
  bool Flush(std::chrono::milliseconds time);

 private:
  struct Line {
    std::string text;
    std::uint64_t left_out = 0;  // lines dropped before this one
  };
  struct Shared {
    Shared(std::size_t most, WriteLine by, const TimeSource& at)
        : max_waiting(most), write(std::move(by)), time(at) {}

    const std::size_t max_waiting;
    const WriteLine write;
    const TimeSource& time;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Line> waiting;
    std::uint64_t left_out = 0;  // lines dropped since the last waiting line
    bool writing = false;
    bool ending = false;
  };

  static void Run(Shared& shared);
  // Returns whether the line was written.
  static bool TryWrite(const Shared& shared, const Line& line);

  const std::shared_ptr<Shared> shared_;
  const LooseThread thread_;
};

}  // namespace thunderhead::base
