#include "base/line_writer.h"

#include <exception>
#include <new>
#include <utility>

namespace thunderhead::base {

LineWriter::LineWriter(std::size_t max_waiting, WriteLine write, const TimeSource& time)
    : shared_(std::make_shared<Shared>(max_waiting, std::move(write), time)),
      thread_(
          "writing lines", [shared = shared_] { Run(*shared); }, time) {}

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
    try {
      shared_->waiting.push_back({std::move(line), shared_->left_out});
      shared_->left_out = 0;
    } catch (const std::bad_alloc&) {
      ++shared_->left_out;
      return;
    }
  }
  shared_->changed.notify_all();
}

bool LineWriter::Flush(std::chrono::milliseconds time) {
  std::unique_lock lock(shared_->mutex);
  return WaitUntil(shared_->time, shared_->changed, lock, shared_->time.Now() + time,
                   [&] { return shared_->waiting.empty() && !shared_->writing; });
}

bool LineWriter::TryWrite(const Shared& shared, const Line& line) {
  try {
    shared.write(line.text, line.left_out);
    return true;
  } catch (const std::exception&) {
    return false;  // for example, out of memory
  }
}

void LineWriter::Run(Shared& shared) {
  std::uint64_t lost = 0;  // lines dropped before the next waiting line
  std::unique_lock lock(shared.mutex);
  while (true) {
    shared.changed.wait(lock, [&] { return shared.ending || !shared.waiting.empty(); });
    if (shared.waiting.empty()) break;
    Line line = std::move(shared.waiting.front());
    shared.waiting.pop_front();
    shared.writing = true;
    lock.unlock();
    line.left_out += lost;
    lost = TryWrite(shared, line) ? 0 : line.left_out + 1;
    lock.lock();
    shared.writing = false;
    shared.changed.notify_all();
  }
  const Line last{"", lost + shared.left_out};
  lock.unlock();
  if (last.left_out > 0) (void)TryWrite(shared, last);
}

}  // namespace thunderhead::base
