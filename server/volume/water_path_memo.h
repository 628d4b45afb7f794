// Remembers by what the columns of volumes keep their water paths: sessions show times again, and
// media are made again after memory was given to others. Knows no scene and no GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>

#include "volume/water_paths.h"

namespace thunderhead::volume {

// For any thread.
class WaterPathMemo {
 public:
  // Forgets what has not been asked for longest when it holds more.
  explicit WaterPathMemo(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // As KeepWaterPaths, which it calls for a volume, control and detail that it does not remember.
  // Only full effort is remembered. Returns the effort that they were found with: at least
  // `effort`.
  WaterPathEffort Keep(const PlacedDetail& detail, DetailControl* control, ExtinctionVolume* volume,
                       WaterPathEffort effort);

 private:
  struct Entry {
    std::uint64_t key = 0;  // of the contents of volume, control and detail
    std::shared_ptr<const WaterPaths> paths;
  };

  std::shared_ptr<const WaterPaths> Find(std::uint64_t key);  // null if it is not remembered
  void Add(Entry entry);

  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // the one asked for last comes first
  std::size_t bytes_ = 0;
};

}  // namespace thunderhead::volume
