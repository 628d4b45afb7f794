#include "base/loose_thread.h"

#include <atomic>
#include <utility>

#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

std::atomic<bool> any_left_behind{false};

}  // namespace

LooseThread::LooseThread(std::string name, std::function<void()> run, const TimeSource& time)
    : time_(&time), name_(std::move(name)) {
  std::packaged_task<void()> task(std::move(run));
  ended_ = task.get_future();
  thread_ = std::thread(std::move(task));
}

LooseThread::~LooseThread() {
  if (thread_.joinable()) LetGoBy(time_->Now() + kPatience);
}

void LooseThread::LetGoBy(Time deadline) {
  if (!thread_.joinable()) return;
  if (EndsBy(deadline)) {
    thread_.join();
    return;
  }
  spdlog::error("{} does not return, so its thread is abandoned", name_);
  any_left_behind = true;
  thread_.detach();
}

bool LooseThread::EndsBy(Time deadline) const {
  while (!HasEnded()) {
    if (time_->Now() >= deadline) return false;
    ended_.wait_until(time_->LookAgainAt(deadline));
  }
  return true;
}

bool LooseThread::HasEnded() const {
  return ended_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

bool LooseThread::AnyLeftBehind() { return any_left_behind; }

}  // namespace thunderhead::base
