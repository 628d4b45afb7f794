// A cache of storms' times with a byte budget; the least recently used are evicted first, but none
// that somebody else holds, as that would free nothing. Not thread-safe.
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

// A time of a storm: its place in the store, and the time's number there, which stays when other
// times come and go.
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

  // The fields, which become the most recently used; null if they are not cached.
  std::shared_ptr<const volume::HydrometeorFields> Use(const TimeKey& key);

  bool Holds(const TimeKey& key) const { return entries_.contains(key); }

  // Caches `fields` as the most recently used and evicts others until the budget is met or none is
  // left that may be evicted.
  void Insert(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields);

  // Caches `fields` as less recently used than the newest entry (the one in view), if both fit.
  void InsertAhead(const TimeKey& key, std::shared_ptr<const volume::HydrometeorFields> fields);

  // True if somebody else holds the fields too.
  bool InUse(const TimeKey& key) const;

  // When the least recently used of those that nobody else holds was used; none if there is none.
  std::optional<std::chrono::steady_clock::time_point> OldestUnused() const;
  // Evicts that one, if there is one; returns it, as freeing much memory takes a while.
  std::shared_ptr<const volume::HydrometeorFields> TakeOldestUnused();

  // Evicts one time, if it is cached.
  void Remove(const TimeKey& key);

  // Evicts all times of a storm.
  void RemoveStorm(std::size_t storm);

  std::size_t Bytes() const { return bytes_; }

  // Bytes of the most recently used entry.
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
  // The least recently used that nobody else holds, or the end.
  std::list<TimeKey>::const_reverse_iterator FindOldestUnused() const;
  void Shrink();

  std::size_t byte_budget_;
  std::size_t bytes_ = 0;
  std::list<TimeKey> newest_first_;
  std::map<TimeKey, Entry> entries_;
};

}  // namespace thunderhead::storm_store
