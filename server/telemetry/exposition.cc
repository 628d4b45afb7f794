#include "telemetry/exposition.h"

#include <unistd.h>

#include <fstream>
#include <limits>
#include <utility>

#include "prometheus/metric_family.h"
#include "prometheus/text_serializer.h"

namespace thunderhead::telemetry {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;

MetricFamily Family(const std::string& name, const std::string& help, MetricType type) {
  MetricFamily family;
  family.name = name;
  family.help = help;
  family.type = type;
  return family;
}

void Label(const char* name, const std::string& value, ClientMetric& metric) {
  if (*name == '\0') return;
  ClientMetric::Label label;
  label.name = name;
  label.value = value;
  metric.label.push_back(std::move(label));
}

ClientMetric MetricOf(const Counter& counter) {
  ClientMetric metric;
  metric.counter.value = static_cast<double>(counter.Value());
  return metric;
}

ClientMetric MetricOf(const Histogram& histogram) {
  ClientMetric metric;
  std::uint64_t total = 0;
  for (std::size_t bucket = 0; bucket <= Histogram::kBounds; ++bucket) {
    total += histogram.Count(bucket);
    ClientMetric::Bucket below;
    below.cumulative_count = total;
    below.upper_bound = bucket < Histogram::kBounds ? Histogram::BoundOf(bucket)
                                                    : std::numeric_limits<double>::infinity();
    metric.histogram.bucket.push_back(below);
  }
  metric.histogram.sample_count = total;
  metric.histogram.sample_sum = histogram.Sum();
  return metric;
}

template <typename Kind>
MetricFamily FamilyOf(const std::string& name, const std::string& help, MetricType type,
                      const char* label, const Labelled<Kind>& kinds) {
  MetricFamily family = Family(name, help, type);
  kinds.ForEach([&](const std::string& value, const Kind& kind) {
    ClientMetric metric = MetricOf(kind);
    Label(label, value, metric);
    family.metric.push_back(std::move(metric));
  });
  return family;
}

template <typename Kind>
MetricFamily FamilyOf(const std::string& name, const std::string& help, MetricType type,
                      const Kind& kind) {
  MetricFamily family = Family(name, help, type);
  family.metric.push_back(MetricOf(kind));
  return family;
}

}  // namespace

std::string Expose(const Metrics& metrics, const std::vector<Gauge>& gauges) {
  constexpr MetricType kCounter = MetricType::Counter;
  constexpr MetricType kHistogram = MetricType::Histogram;
  std::vector<MetricFamily> families{
      FamilyOf("thunderhead_frames_total", "Frames drawn and encoded", kCounter, "technique",
               metrics.frames),
      FamilyOf("thunderhead_stage_seconds", "Time that each stage of a frame took", kHistogram,
               "stage", metrics.stages),
      FamilyOf("thunderhead_update_to_frame_seconds",
               "Time from a change of a scene to a viewer's acknowledgement of its first frame",
               kHistogram, metrics.update_to_frame),
      FamilyOf("thunderhead_frames_sent_total", "Frames sent to viewers", kCounter,
               metrics.frames_sent),
      FamilyOf("thunderhead_frames_skipped_total",
               "Frames that were not sent to a viewer, because a newer one was ready first",
               kCounter, metrics.frames_skipped),
      FamilyOf("thunderhead_frame_bytes_sent_total", "Bytes of pictures sent to viewers", kCounter,
               metrics.frame_bytes_sent),
      FamilyOf("thunderhead_refusals_total", "Responses that are errors", kCounter, "reason",
               metrics.refusals),
      FamilyOf("thunderhead_sessions_opened_total", "Sessions opened", kCounter,
               metrics.sessions_opened),
      FamilyOf("thunderhead_session_save_failures_total",
               "Attempts to save sessions that failed; each is made again half a second later",
               kCounter, metrics.session_save_failures),
      FamilyOf("thunderhead_session_damages_total",
               "Sessions of an earlier run that could not be restored, or only without their marks",
               kCounter, metrics.session_damages),
      FamilyOf("thunderhead_job_pictures_total", "Pictures of render jobs", kCounter, "outcome",
               metrics.job_pictures),
      FamilyOf("thunderhead_device_losses_total",
               "Times that the device was reset, or could not be opened again after that", kCounter,
               metrics.device_losses),
      FamilyOf("thunderhead_reader_failures_total",
               "Readers of storm files that failed: crashed, killed, too slow, or with an "
               "implausible answer",
               kCounter, "reason", metrics.reader_failures)};
  for (const Gauge& gauge : gauges) {
    if (families.back().name != gauge.name) {
      families.push_back(Family(gauge.name, gauge.help, MetricType::Gauge));
    }
    ClientMetric metric;
    Label(gauge.label.c_str(), gauge.label_value, metric);
    metric.gauge.value = gauge.value;
    families.back().metric.push_back(std::move(metric));
  }
  return prometheus::TextSerializer().Serialize(families);
}

double ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  if (!(statm >> total_pages >> resident_pages)) return 0.0;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace thunderhead::telemetry
