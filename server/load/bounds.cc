#include "load/bounds.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace thunderhead::load {
namespace {

void Check(bool kept, const std::string& figure, const std::string& bound,
           std::vector<std::string>* not_kept) {
  if (!kept) not_kept->push_back(absl::StrCat(figure, ", ", bound));
}

void CheckUpperBound(const std::optional<double>& bound, const std::optional<double>& figure,
                     const std::string& name, const std::string& unit,
                     std::vector<std::string>* not_kept) {
  if (!bound.has_value()) return;
  const std::string measured = figure.has_value()
                                   ? absl::StrFormat("%s %.0f %s", name, *figure, unit)
                                   : absl::StrCat(name, " not measured");
  Check(figure.has_value() && *figure <= *bound, measured,
        absl::StrFormat("at most %g %s wanted", *bound, unit), not_kept);
}

}  // namespace

std::vector<std::string> NotKept(const Bounds& bounds, const Report& report) {
  std::vector<std::string> not_kept;
  const ViewerFigures& viewers = report.Main();
  if (bounds.min_fps.has_value()) {
    Check(viewers.fps_min >= *bounds.min_fps,
          absl::StrFormat("least frames/s %.1f", viewers.fps_min),
          absl::StrFormat("at least %g wanted", *bounds.min_fps), &not_kept);
  }
  std::optional<double> p95_ms;
  std::optional<double> p99_ms;
  if (viewers.latency_ms.has_value()) {
    p95_ms = viewers.latency_ms->p95;
    p99_ms = viewers.latency_ms->p99;
  }
  CheckUpperBound(bounds.max_p95_ms, p95_ms, "latency p95", "ms", &not_kept);
  CheckUpperBound(bounds.max_p99_ms, p99_ms, "latency p99", "ms", &not_kept);
  std::optional<double> spread_ms;
  if (viewers.spread_ms.has_value()) spread_ms = viewers.spread_ms->p99;
  CheckUpperBound(bounds.max_spread_ms, spread_ms, "first to last viewer p99", "ms", &not_kept);
  std::optional<double> growth_mb;
  if (report.server.has_value()) {
    growth_mb = report.server->rss_last_mb - report.server->rss_first_mb;
  }
  CheckUpperBound(bounds.max_growth_mb, growth_mb, "growth of the server's memory", "MB",
                  &not_kept);
  return not_kept;
}

}  // namespace thunderhead::load
