#include "load/report.h"

#include <algorithm>
#include <cstdint>

namespace thunderhead::load {
namespace {

constexpr std::size_t kMaxSamples = 20;

ViewerFigures FiguresOf(const Recording& recording, ViewerKind kind) {
  ViewerFigures figures;
  std::vector<double> fps;
  std::vector<Latency> latencies;
  std::uint64_t bytes = 0;
  std::uint64_t frames = 0;
  std::uint64_t frame_bytes = 0;
  std::vector<const std::vector<Arrival>*> arrivals;
  for (const ViewerRecord* viewer : recording.viewers) {
    if (viewer->kind != kind) continue;
    fps.push_back(FramesPerSecond(viewer->frames, recording.period));
    const auto of_one = LatenciesOf(recording.updates, viewer->frames, recording.period);
    latencies.insert(latencies.end(), of_one.begin(), of_one.end());
    arrivals.push_back(&viewer->frames);
    bytes += viewer->bytes;
    frames += viewer->frame_count;
    frame_bytes += viewer->frame_bytes;
  }
  if (fps.empty()) return figures;
  figures.viewers = static_cast<int>(fps.size());
  figures.fps_min = std::ranges::min(fps);
  figures.fps_median = *Percentile(fps, 0.5);
  figures.latency_ms = PercentilesOf(latencies);
  figures.spread_ms = PercentilesOf(SpreadsOf(recording.updates, arrivals, recording.period));
  figures.latency_growth = GrowthOf(latencies, recording.period);
  if (recording.period.Seconds() > 0.0) {
    figures.kbit_per_viewer = 8e-3 * static_cast<double>(bytes) / recording.period.Seconds() /
                              static_cast<double>(fps.size());
  }
  if (frames > 0) {
    figures.bytes_per_frame = static_cast<double>(frame_bytes) / static_cast<double>(frames);
  }
  return figures;
}

std::optional<ServerFigures> FiguresOf(const std::vector<ProcessSample>& samples) {
  if (samples.empty()) return std::nullopt;
  const ProcessSample& first = samples.front();
  const ProcessSample& last = samples.back();
  ServerFigures figures{
      .rss_first_mb = first.rss_mb,
      .rss_last_mb = last.rss_mb,
      .rss_most_mb = std::ranges::max(samples, {}, &ProcessSample::rss_mb).rss_mb};
  if (last.at_s > first.at_s) figures.cpu = (last.cpu_s - first.cpu_s) / (last.at_s - first.at_s);
  const std::size_t step = (samples.size() + kMaxSamples - 1) / kMaxSamples;
  for (std::size_t i = 0; i < samples.size(); i += step) {
    figures.rss_over_time_mb.emplace_back(samples[i].at_s - first.at_s, samples[i].rss_mb);
  }
  return figures;
}

FirstFrames FirstFramesOf(const Recording& recording, ViewerKind kind) {
  std::vector<double> all_ms;
  for (const ViewerRecord* viewer : recording.viewers) {
    if (viewer->kind != kind) continue;
    all_ms.insert(all_ms.end(), viewer->first_frames_ms.begin(), viewer->first_frames_ms.end());
  }
  return {all_ms.size(), Percentile(all_ms, 0.5), Percentile(all_ms, 1.0)};
}

int CountOf(const Recording& recording, ViewerKind kind) {
  return static_cast<int>(std::ranges::count(recording.viewers, kind, &ViewerRecord::kind));
}

}  // namespace

int Report::ErrorCount() const {
  int count = 0;
  for (const auto& [message, times] : errors) count += times;
  return count;
}

Report ReportOf(const Recording& recording) {
  Report report;
  report.seconds = recording.period.Seconds();
  report.healthy = FiguresOf(recording, ViewerKind::kHealthy);
  report.looking = FiguresOf(recording, ViewerKind::kLooking);
  report.looking.latency_ms.reset();
  report.looking.spread_ms.reset();
  report.looking.latency_growth = {};
  report.throttled = FiguresOf(recording, ViewerKind::kThrottled);
  report.stalled = CountOf(recording, ViewerKind::kStalled);
  report.passing = CountOf(recording, ViewerKind::kPassing);
  report.healthy_first = FirstFramesOf(recording, ViewerKind::kHealthy);
  report.looking_first = FirstFramesOf(recording, ViewerKind::kLooking);
  report.throttled_first = FirstFramesOf(recording, ViewerKind::kThrottled);
  report.passing_first = FirstFramesOf(recording, ViewerKind::kPassing);
  const std::vector<double>& came_ms = recording.images.came_ms;
  report.images = {recording.images.asked, static_cast<int>(came_ms.size()),
                   Percentile(came_ms, 0.5), Percentile(came_ms, 1.0)};
  report.server = FiguresOf(recording.server);
  if (report.seconds > 0.0) report.own_cpu = recording.own_cpu_s / report.seconds;
  report.errors = recording.errors;
  return report;
}

}  // namespace thunderhead::load
