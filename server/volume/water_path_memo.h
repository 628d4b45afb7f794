// A cache of the factors that KeepWaterPaths computes. A session needs the factors again when it
// returns to an earlier time of the storm. It also needs them when it rebuilds a medium whose
// memory was evicted. This code does not depend on scenes or GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>

#include "volume/water_paths.h"

namespace thunderhead::volume {

// The cache may be used by any thread.
class WaterPathMemo {
 public:
  // Creates a cache that evicts the least recently used entries when it holds more than
  // `most_bytes`.
  explicit WaterPathMemo(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Does the same as KeepWaterPaths, but uses cached factors if the same volume, control and detail
  // are in the cache. Otherwise it calls KeepWaterPaths. Only results of full effort are cached.
  // Returns the effort with which the paths were found, which is at least `effort`.
  WaterPathEffort Keep(const PlacedDetail& detail, DetailControl* control, ExtinctionVolume* volume,
                       WaterPathEffort effort);

 private:
  struct Entry {
    std::uint64_t key = 0;  // hash of the contents of volume, control and detail
    std::shared_ptr<const WaterPaths> paths;
  };

  std::shared_ptr<const WaterPaths> Find(std::uint64_t key);  // null if it is not cached
  void Add(Entry entry);

  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // the most recently used comes first
  std::size_t bytes_ = 0;
};

}  // namespace thunderhead::volume
