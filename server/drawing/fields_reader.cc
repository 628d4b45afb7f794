#include "drawing/fields_reader.h"

#include <algorithm>
#include <utility>

#include "base/guarded.h"
#include "base/stopwatch.h"

namespace thunderhead::drawing {

FieldsReader::FieldsReader(storm_store::StormStore& store, std::function<void()> on_read)
    : store_(store), on_read_(std::move(on_read)), thread_([this] { Run(); }) {}

FieldsReader::~FieldsReader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void FieldsReader::Ask(const std::string& owner, const FieldsKey& key, PrepareFields prepare) {
  {
    const std::lock_guard lock(mutex_);
    asked_[owner] = {key, std::move(prepare), ++count_};
    read_.erase(owner);
    if (std::find(waiting_.begin(), waiting_.end(), owner) == waiting_.end()) {
      waiting_.push_back(owner);
    }
  }
  changed_.notify_one();
}

void FieldsReader::AskAhead(const std::string& owner, const FieldsKey& key, PrepareFields prepare) {
  {
    const std::lock_guard lock(mutex_);
    ahead_[owner] = {key, std::move(prepare), ++count_};
  }
  changed_.notify_one();
}

std::optional<FieldsRead> FieldsReader::Take(const std::string& owner) {
  const std::lock_guard lock(mutex_);
  auto read = read_.extract(owner);
  if (read.empty()) return std::nullopt;
  return std::move(read.mapped());
}

void FieldsReader::Forget(const std::string& owner) {
  const std::lock_guard lock(mutex_);
  waiting_.erase(std::remove(waiting_.begin(), waiting_.end(), owner), waiting_.end());
  asked_.erase(owner);
  read_.erase(owner);
  ahead_.erase(owner);
}

FieldsRead FieldsReader::Read(const Asked& work) {
  base::Stopwatch stopwatch;
  FieldsRead read;
  read.fields =
      base::Guarded([&] { return store_.Get(work.key.storm_id, work.key.time_index, {}); });
  read.milliseconds = stopwatch.Restart();
  if (!read.fields.ok() || !work.prepare) return read;
  const absl::Status prepared = base::Guarded([&] { return work.prepare(*read.fields); });
  if (!prepared.ok()) read.fields = prepared;
  read.prepare_ms = stopwatch.ElapsedMs();
  return read;
}

void FieldsReader::ServeFirst(std::unique_lock<std::mutex>& lock) {
  const std::string owner = std::move(waiting_.front());
  waiting_.pop_front();
  const Asked work = asked_[owner];
  lock.unlock();
  FieldsRead read = Read(work);
  lock.lock();
  // The request is obsolete if the owner was forgotten or made another request during the read.
  const auto asked = asked_.find(owner);
  if (asked == asked_.end() || asked->second.count != work.count) return;
  asked_.erase(asked);
  read_.insert_or_assign(owner, std::move(read));
  lock.unlock();
  on_read_();
  lock.lock();
}

void FieldsReader::ServeAhead(std::unique_lock<std::mutex>& lock) {
  const Asked work = std::move(ahead_.extract(ahead_.begin()).mapped());
  lock.unlock();
  // The result of a prefetch is ignored. If it failed, a later request will report the error.
  Read(work);
  lock.lock();
}

void FieldsReader::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !waiting_.empty() || !ahead_.empty(); });
    if (stopping_) return;
    if (waiting_.empty()) {
      ServeAhead(lock);
    } else {
      ServeFirst(lock);
    }
  }
}

}  // namespace thunderhead::drawing
