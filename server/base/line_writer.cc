#include "base/line_writer.h"

#include <utility>

namespace thunderhead::base {

LineWriter::LineWriter(std::size_t max_waiting, WriteLine write)
    : shared_(std::make_shared<Shared>(max_waiting, std::move(write))),
      thread_("writing lines", [shared = shared_] { Run(*shared); }) {}

LineWriter::~LineWriter() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ending = true;
  }
  shared_->changed.notify_all();
}

void LineWriter::Write(std::string line) {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->waiting.size() >= shared_->max_waiting) {
      ++shared_->left_out;
      return;
    }
    shared_->waiting.push_back({std::move(line), std::exchange(shared_->left_out, 0)});
  }
  shared_->changed.notify_all();
}

void LineWriter::Run(Shared& shared) {
  std::unique_lock lock(shared.mutex);
  while (true) {
    shared.changed.wait(lock, [&] { return shared.ending || !shared.waiting.empty(); });
    if (shared.waiting.empty()) return;
    const Line line = std::move(shared.waiting.front());
    shared.waiting.pop_front();
    lock.unlock();
    shared.write(line.text, line.left_out);
    lock.lock();
  }
}

}  // namespace thunderhead::base
