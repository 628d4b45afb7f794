#include "app/interruption.h"

#include <chrono>
#include <ctime>

namespace thunderhead::app {
namespace {

sigset_t Signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

Interruption::Interruption() {
  const sigset_t signals = Signals();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
  waiter_ = std::jthread([this, signals](const std::stop_token& ended) {
    constexpr timespec kStep{0, 100'000'000};
    while (!ended.stop_requested()) {
      if (stop_.stop_requested()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      } else if (sigtimedwait(&signals, nullptr, &kStep) > 0) {
        stop_.request_stop();
        // This is then the one thread that does not hold the next signal back.
        pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
      }
    }
  });
}

Interruption::~Interruption() {
  waiter_.request_stop();
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace thunderhead::app
