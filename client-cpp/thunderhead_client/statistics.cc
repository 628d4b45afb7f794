#include "thunderhead_client/statistics.h"

#include <algorithm>
#include <vector>

namespace thunderhead::client {
namespace {

constexpr std::chrono::seconds kWindow{2};
constexpr std::size_t kMaxLatencies = 60;
constexpr std::size_t kMaxOpen = 64;
constexpr double kSeconds = 2.0;

template <typename Entries>
void Forget(Entries& entries, std::chrono::steady_clock::time_point before) {
  while (!entries.empty() && entries.front().at < before) entries.pop_front();
}

}  // namespace

void Statistics::StreamBegan() {
  const std::lock_guard lock(mutex_);
  sent_.clear();
  shown_.clear();
}

void Statistics::Received(std::size_t bytes, TimePoint at) {
  const std::lock_guard lock(mutex_);
  bytes_ += bytes;
  parcels_.push_back({at, bytes});
  Forget(parcels_, at - kWindow);
}

void Statistics::AddLatency(TimePoint sent_at, TimePoint shown_at) {
  latencies_ms_.push_back(std::chrono::duration<double, std::milli>(shown_at - sent_at).count());
  if (latencies_ms_.size() > kMaxLatencies) latencies_ms_.pop_front();
}

void Statistics::SceneTaken(std::uint64_t revision, TimePoint sent_at) {
  const std::lock_guard lock(mutex_);
  const auto shown = shown_.lower_bound(revision);
  if (shown != shown_.end()) return AddLatency(sent_at, shown->second);
  sent_[revision] = sent_at;
  if (sent_.size() > kMaxOpen) sent_.erase(sent_.begin());
}

void Statistics::Shown(std::uint64_t revision, double decode_ms, TimePoint at) {
  const std::lock_guard lock(mutex_);
  Count(decode_ms, at);
  shown_.emplace(revision, at);
  if (shown_.size() > kMaxOpen) shown_.erase(shown_.begin());
  while (!sent_.empty() && sent_.begin()->first <= revision) {
    AddLatency(sent_.begin()->second, at);
    sent_.erase(sent_.begin());
  }
}

void Statistics::ShownOwn(double decode_ms, TimePoint at) {
  const std::lock_guard lock(mutex_);
  Count(decode_ms, at);
}

void Statistics::Count(double decode_ms, TimePoint at) {
  ++frames_;
  shots_.push_back({at, decode_ms});
  Forget(shots_, at - kWindow);
}

Statistics::Figures Statistics::At(TimePoint now) const {
  const std::lock_guard lock(mutex_);
  Figures figures;
  double decode_ms = 0.0;
  double count = 0.0;
  for (const Shot& shot : shots_) {
    if (shot.at < now - kWindow) continue;
    decode_ms += shot.decode_ms;
    count += 1.0;
  }
  double bytes = 0.0;
  for (const Parcel& parcel : parcels_) {
    if (parcel.at >= now - kWindow) bytes += static_cast<double>(parcel.bytes);
  }
  figures.frames_per_s = count / kSeconds;
  figures.bytes_per_s = bytes / kSeconds;
  if (count > 0.0) figures.decode_ms = decode_ms / count;
  if (!latencies_ms_.empty()) {
    std::vector<double> sorted(latencies_ms_.begin(), latencies_ms_.end());
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    figures.latency_ms = sorted[sorted.size() / 2];
  }
  figures.frames = frames_;
  figures.bytes = bytes_;
  return figures;
}

}  // namespace thunderhead::client
