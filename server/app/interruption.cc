#include "app/interruption.h"

#include <pthread.h>

#include <chrono>
#include <ctime>

#include "app/stop_signals.h"

namespace thunderhead::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Waits for one of `signals`. Returns false if none came within `wait`.
bool Taken(const sigset_t& signals, milliseconds wait) {
  const timespec limit{0, std::chrono::nanoseconds(wait).count()};
  return sigtimedwait(&signals, nullptr, &limit) > 0;
}

// One request may arrive as several signals. A terminal, a shell and coreutils' timeout each signal
// the program and its process group.
constexpr milliseconds kOneInterruption(250);

// The thread gets this name when a further signal would end the program.
constexpr char kInterrupted[] = "interrupted";

}  // namespace

Interruption::Interruption() {
  const sigset_t signals = StopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
  waiter_ = std::jthread([this, signals](const std::stop_token& ended) {
    while (!Taken(signals, milliseconds(100))) {
      if (ended.stop_requested()) return;
    }
    stop_.request_stop();
    const auto whole = steady_clock::now() + kOneInterruption;
    while (steady_clock::now() < whole) Taken(signals, milliseconds(20));
    // Signals that arrived while this thread could not run belong to the same request.
    while (Taken(signals, milliseconds(0))) {
    }
    // Only this thread unblocks the signals, so that the next one ends the program.
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    pthread_setname_np(pthread_self(), kInterrupted);
    while (!ended.stop_requested()) std::this_thread::sleep_for(milliseconds(20));
  });
}

Interruption::~Interruption() {
  waiter_.request_stop();
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace thunderhead::app
