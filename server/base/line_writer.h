// Writes lines on a thread of its own, so that a disk that hangs holds up nobody who has something
// to say.
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

namespace thunderhead::base {

class LineWriter {
 public:
  // Writes a line, before which so many were left out; an empty one at the end if it is to say so
  // of the last. A line for which it throws is left out. May hang, so it must own all that it uses.
  using WriteLine = std::function<void(const std::string& line, std::uint64_t left_out)>;

  // Lines beyond `max_waiting` are left out.
  LineWriter(std::size_t max_waiting, WriteLine write);
  // Writes what waits, unless that hangs.
  ~LineWriter();
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  // Returns at once; from any thread.
  void Write(std::string line);
  // Waits until what waits is written, for so long at most; true if it is.
  bool Flush(std::chrono::milliseconds time);

 private:
  struct Line {
    std::string text;
    std::uint64_t left_out = 0;  // before it
  };
  struct Shared {
    Shared(std::size_t most, WriteLine by) : max_waiting(most), write(std::move(by)) {}

    const std::size_t max_waiting;
    const WriteLine write;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Line> waiting;
    std::uint64_t left_out = 0;  // since the last that waits
    bool writing = false;
    bool ending = false;
  };

  static void Run(Shared& shared);
  // True if it is written.
  static bool TryWrite(const Shared& shared, const Line& line);

  const std::shared_ptr<Shared> shared_;
  const LooseThread thread_;
};

}  // namespace thunderhead::base
