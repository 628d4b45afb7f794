// Converts Ctrl-C (SIGINT) and the other signals of stop_signals.h to a request to stop, for work
// that then reports its partial result. Signals within a quarter of a second count as one request.
// A later signal has its default effect: it ends the program.
#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

namespace thunderhead::app {

class Interruption {
 public:
  // Blocks the signals in this thread and in all threads that it starts later, and waits for them
  // in a separate thread.
  Interruption();
  // Restores the signal mask. It first waits until all signals of one request have arrived.
  // Otherwise a late signal could end the program before it has written its result.
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  std::stop_token Token() const { return stop_.get_token(); }

 private:
  std::stop_source stop_;
  sigset_t before_{};
  std::jthread waiter_;
};

}  // namespace thunderhead::app
