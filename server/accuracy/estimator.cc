#include "accuracy/estimator.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "accuracy/named_settings.h"
#include "accuracy/offers.h"

namespace thunderhead::accuracy {
namespace {

// Returns the setting of a frame of that quality whose light is corrected by `traced_paths`.
Setting DrawnWith(Setting setting, const FrameQuality& quality, std::int64_t traced_paths) {
  if (const auto slices = scene::SlicesOf(setting.technique); slices.has_value()) {
    const int drawn = static_cast<int>(std::ceil(*slices * quality.slice_share));
    scene::SetSlices(&setting.technique, std::max(drawn, 1));
  }
  setting.image_scale *= quality.Scale();
  setting.million_paths = static_cast<double>(traced_paths) / 1e6;
  return setting;
}

}  // namespace

double DiscretisationError(const std::vector<float>& half, const std::vector<float>& full) {
  double squares = 0.0;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    if (i % 4 == 3) continue;
    squares += std::pow(static_cast<double>(half[i]) - full[i], 2);
    sum += full[i];
    ++count;
  }
  const double values = static_cast<double>(count);
  return sum > 0.0 ? std::sqrt(squares / values) / (sum / values) : 0.0;
}

std::optional<AccuracyReport> Estimator::Report(const scene::Scene& scene,
                                                const FrameQuality& quality,
                                                const Evidence& evidence) const {
  const auto& table = TableFor(tables_, scene);
  if (!table.ok()) return std::nullopt;
  const Setting full = SettingOf(scene);
  const Setting drawn = DrawnWith(full, quality, evidence.traced_paths);
  const PricedSetting* const row = NearestRow(*table, drawn);
  const PricedSetting* const timed = NearestRow(*table, Untraced(full));
  if (row == nullptr || timed == nullptr) return std::nullopt;
  AccuracyReport report;
  report.technique = full.technique;
  report.slices = scene::CountOf(drawn.technique);
  report.image_scale = drawn.image_scale;
  report.model_error = row->relative_rmse;
  report.discretisation_error = evidence.discretisation_error;
  // The table's error already includes part of the error that a finite number of slices causes. The
  // result therefore contains this part twice, so the estimate is rather too high than too low.
  report.estimated_error =
      std::hypot(row->relative_rmse, evidence.discretisation_error.value_or(0.0));
  report.measured = evidence.measured;
  if (report.measured.has_value()) report.estimated_error = report.measured->relative_rmse.value;
  const double expected_ms = costs_.SettingMs(*table, *timed, scene);
  const bool asks = !std::holds_alternative<std::monostate>(scene.accuracy);
  if (asks || costs_.Knows(full)) report.expected_ms = expected_ms;
  // A coarse frame, or a frame with few paths, is only shown until the full frame is ready. The
  // full frame decides whether the request is met.
  const PricedSetting& full_row = *NearestRow(*table, full);
  const bool is_full =
      quality == FrameQuality{} && row->setting.million_paths == full_row.setting.million_paths;
  const double error =
      is_full || evidence.is_last ? report.estimated_error : full_row.relative_rmse;
  report.unmet = WhyUnmet(scene, {full, expected_ms, error});
  return report;
}

std::int64_t Estimator::PathsFor(const scene::Scene& scene, const MeasuredErrors& errors) const {
  const auto* limit = std::get_if<scene::MaxError>(&scene.accuracy);
  const auto& table = TableFor(tables_, scene);
  if (limit == nullptr || !table.ok()) return kImagePaths;
  std::int64_t fewest = kTracedPaths;
  for (const PricedSetting& row : table->rows) {
    const std::int64_t paths = std::llround(1e6 * row.setting.million_paths);
    const double factor = errors.FactorOf(row.setting);
    if (factor * row.relative_rmse > limit->relative_rmse || paths >= fewest) continue;
    const auto report = Report(scene, {}, {.traced_paths = paths});
    if (report.has_value() && factor * report->estimated_error <= limit->relative_rmse) {
      fewest = paths;
    }
  }
  return fewest;
}

}  // namespace thunderhead::accuracy
