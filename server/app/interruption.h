// Ctrl-C (SIGINT) and SIGTERM as a request to stop, for work that then reports what it has. What
// follows within a quarter of a second is the same request; a later signal ends the program as
// usual.
#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

namespace thunderhead::app {

class Interruption {
 public:
  // From here on the signals are taken; threads started later leave them to this one.
  Interruption();
  // The signals are as they were. Waits until a request has come whole, so that its rest does not
  // end the program before it has written what it reports.
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
