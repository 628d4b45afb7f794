#include "storm_store/fields_cache.h"

#include <algorithm>
#include <utility>

namespace thunderhead::storm_store {

std::shared_ptr<const volume::HydrometeorFields> FieldsCache::Use(const TimeKey& key) {
  const auto at = entries_.find(key);
  if (at == entries_.end()) return nullptr;
  newest_first_.splice(newest_first_.begin(), newest_first_, at->second.order);
  at->second.used = std::chrono::steady_clock::now();
  return at->second.fields;
}

void FieldsCache::Insert(const TimeKey& key,
                         std::shared_ptr<const volume::HydrometeorFields> fields) {
  Remove(key);
  Add(key, std::move(fields), newest_first_.begin());
  Shrink();
}

void FieldsCache::InsertAhead(const TimeKey& key,
                              std::shared_ptr<const volume::HydrometeorFields> fields) {
  if (newest_first_.empty() || newest_first_.front() == key) {
    Insert(key, std::move(fields));
    return;
  }
  Remove(key);
  Add(key, std::move(fields), std::next(newest_first_.begin()));
  Shrink();
}

bool FieldsCache::InUse(const TimeKey& key) const {
  const auto at = entries_.find(key);
  return at != entries_.end() && at->second.fields.use_count() > 1;
}

void FieldsCache::RemoveStorm(std::size_t storm) {
  // The loop works because keys are ordered by storm.
  auto at = entries_.lower_bound(TimeKey{storm, 0});
  while (at != entries_.end() && at->first.storm == storm) Remove(TimeKey((at++)->first));
}

std::size_t FieldsCache::NewestBytes() const {
  return newest_first_.empty() ? 0 : entries_.at(newest_first_.front()).bytes;
}

void FieldsCache::Add(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields,
                      std::list<TimeKey>::iterator before) {
  const std::size_t bytes = fields->Bytes();
  const auto order = newest_first_.insert(before, key);
  entries_[key] = {std::move(fields), bytes, order, std::chrono::steady_clock::now()};
  bytes_ += bytes;
}

void FieldsCache::Remove(const TimeKey& key) {
  const auto at = entries_.find(key);
  if (at == entries_.end()) return;
  bytes_ -= at->second.bytes;
  newest_first_.erase(at->second.order);
  entries_.erase(at);
}

std::list<TimeKey>::const_reverse_iterator FieldsCache::FindOldestUnused() const {
  return std::find_if(newest_first_.rbegin(), newest_first_.rend(),
                      [this](const TimeKey& key) { return !InUse(key); });
}

std::optional<std::chrono::steady_clock::time_point> FieldsCache::OldestUnused() const {
  const auto oldest = FindOldestUnused();
  if (oldest == newest_first_.rend()) return std::nullopt;
  return entries_.at(*oldest).used;
}

std::shared_ptr<const volume::HydrometeorFields> FieldsCache::TakeOldestUnused() {
  const auto oldest = FindOldestUnused();
  if (oldest == newest_first_.rend()) return nullptr;
  auto fields = entries_.at(*oldest).fields;
  Remove(TimeKey(*oldest));
  return fields;
}

void FieldsCache::Shrink() {
  while (bytes_ > byte_budget_) {
    const auto oldest = FindOldestUnused();
    if (oldest == newest_first_.rend() || *oldest == newest_first_.front()) return;
    Remove(TimeKey(*oldest));
  }
}

}  // namespace thunderhead::storm_store
