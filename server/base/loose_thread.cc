#include "base/loose_thread.h"

#include <atomic>
#include <utility>

#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

std::atomic<bool> any_left_behind{false};

}  // namespace

LooseThread::LooseThread(std::string name, std::function<void()> run) : name_(std::move(name)) {
  std::packaged_task<void()> task(std::move(run));
  ended_ = task.get_future();
  thread_ = std::thread(std::move(task));
}

LooseThread::~LooseThread() { LetGoAfter(kPatience); }

void LooseThread::LetGoAfter(std::chrono::seconds patience) {
  if (!thread_.joinable()) return;
  if (ended_.wait_for(patience) == std::future_status::ready) {
    thread_.join();
    return;
  }
  spdlog::error("{} hangs and is left behind", name_);
  any_left_behind = true;
  thread_.detach();
}

bool LooseThread::EndsWithin(std::chrono::milliseconds time) const {
  return ended_.wait_for(time) == std::future_status::ready;
}

bool LooseThread::AnyLeftBehind() { return any_left_behind; }

}  // namespace thunderhead::base
