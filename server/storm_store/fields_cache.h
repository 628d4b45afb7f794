// A cache of storms' times with a byte budget. It evicts the least recently used times first. It
// does not evict times that are in use elsewhere, because that would free nothing. It is not
// thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_store {

// Identifies a time of a storm. `storm` is the storm's index in the store, and `time` a number that
// the store gives to the time. The number does not change when other times are added or removed.
struct TimeKey {
  std::size_t storm = 0;
  int time = 0;

  bool operator==(const TimeKey&) const = default;
  bool operator<(const TimeKey& other) const {
    return std::tie(storm, time) < std::tie(other.storm, other.time);
  }
};

class FieldsCache {
 public:
  explicit FieldsCache(std::size_t byte_budget) : byte_budget_(byte_budget) {}

  // Returns the fields, which become the most recently used. Returns null if they are not cached.
  std::shared_ptr<const volume::HydrometeorFields> Use(const TimeKey& key);

  bool Holds(const TimeKey& key) const { return entries_.contains(key); }

  // Caches `fields` as the most recently used. Then evicts other entries until the budget is met or
  // all other entries are in use.
  void Insert(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields);

  // Caches `fields` of a time that was read ahead, if they fit into the budget together with the
  // most recently used entry. The latter, which is the time in view, stays the most recently used.
  void InsertAhead(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields);

  // Returns whether the fields are also in use outside the cache.
  bool InUse(const TimeKey& key) const;

  // Returns the time of last use of the entry that TakeOldestUnused would evict, or nothing if all
  // entries are in use.
  std::optional<std::chrono::steady_clock::time_point> OldestUnused() const;
  // Evicts the least recently used entry that is not in use, if there is one. Returns its fields,
  // so that the caller can free their memory without holding a lock.
  std::shared_ptr<const volume::HydrometeorFields> TakeOldestUnused();

  // Evicts one time, if it is cached.
  void Remove(const TimeKey& key);

  // Evicts all times of a storm.
  void RemoveStorm(std::size_t storm);

  std::size_t Bytes() const { return bytes_; }

  // Returns the bytes of the most recently used entry.
  std::size_t NewestBytes() const;

 private:
  struct Entry {
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::size_t bytes = 0;
    std::list<TimeKey>::iterator order;
    std::chrono::steady_clock::time_point used;
  };

  void Add(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields,
           std::list<TimeKey>::iterator before);
  // Returns the least recently used entry that is not in use elsewhere, or the end.
  std::list<TimeKey>::const_reverse_iterator FindOldestUnused() const;
  void Shrink();

  std::size_t byte_budget_;
  std::size_t bytes_ = 0;
  std::list<TimeKey> newest_first_;
  std::map<TimeKey, Entry> entries_;
};

}  // namespace thunderhead::storm_store
