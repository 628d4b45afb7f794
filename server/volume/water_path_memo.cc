#include "volume/water_path_memo.h"

#include <algorithm>
#include <functional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace thunderhead::volume {
namespace {

// A hash of bytes that are added one after the other.
class ContentHash {
 public:
  template <typename Value>
  void Add(const Value* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<Value>);
    const std::string_view bytes(reinterpret_cast<const char*>(values), count * sizeof(Value));
    // The factor is that of Fowler, Noll and Vo's hash of 64 bits.
    hash_ = (hash_ ^ std::hash<std::string_view>{}(bytes)) * 0x100000001b3U;
  }
  template <typename Value>
  void Add(const std::vector<Value>& values) {
    Add(values.data(), values.size());
  }
  template <typename Value>
  void AddOne(const Value& value) {
    Add(&value, 1);
  }

  std::uint64_t Value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

std::uint64_t KeyOf(const PlacedDetail& detail, const DetailControl& control,
                    const ExtinctionVolume& volume) {
  ContentHash hash;
  hash.AddOne(volume.grid.cells);
  hash.AddOne(volume.grid.low_corner_m);
  hash.AddOne(volume.grid.spacing_m);
  hash.AddOne(volume.extinction_per_m);
  for (const ExtinctionPlane& plane : volume.planes) hash.Add(plane.texels);
  hash.Add(control);
  for (const PlacedDetail::Layer& layer : detail.layers) {
    hash.Add(layer.tile->texels);
    hash.AddOne(layer.tile_m);
    hash.Add(layer.shares);
    hash.AddOne(layer.drift_m);
  }
  hash.AddOne(detail.warp_m);
  hash.AddOne(detail.fibres);
  return hash.Value();
}

std::size_t BytesOf(const WaterPaths& paths) {
  std::size_t bytes =
      sizeof(paths) +
      sizeof(float) * (paths.by_column.size() + paths.by_channel.size() + paths.drawn.size());
  for (const auto& weaker : paths.weakened) bytes += sizeof(WaterPaths::Weaker) * weaker.size();
  return bytes;
}

}  // namespace

WaterPathEffort WaterPathMemo::Keep(const PlacedDetail& detail, DetailControl* control,
                                    ExtinctionVolume* volume, WaterPathEffort effort) {
  const std::uint64_t key = KeyOf(detail, *control, *volume);
  if (const std::shared_ptr<const WaterPaths> found = Find(key)) {
    KeepWaterPathsAgain(*found, control, volume);
    return WaterPathEffort::kFull;
  }
  WaterPaths paths = KeepWaterPaths(detail, control, volume, effort);
  if (effort == WaterPathEffort::kFull) {
    Add({key, std::make_shared<const WaterPaths>(std::move(paths))});
  }
  return effort;
}

std::shared_ptr<const WaterPaths> WaterPathMemo::Find(std::uint64_t key) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::ranges::find_if(entries_, [key](const Entry& entry) { return entry.key == key; });
  if (found == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found);
  return found->paths;
}

void WaterPathMemo::Add(Entry entry) {
  const std::lock_guard lock(mutex_);
  bytes_ += BytesOf(*entry.paths);
  entries_.push_front(std::move(entry));
  while (bytes_ > most_bytes_ && !entries_.empty()) {
    bytes_ -= BytesOf(*entries_.back().paths);
    entries_.pop_back();
  }
}

}  // namespace thunderhead::volume
