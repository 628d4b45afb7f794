#include "accuracy/measured_errors.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::accuracy {
namespace {

bool IsTraced(const Setting& setting) { return setting.million_paths > 0.0; }

bool SameLight(const Setting& a, const Setting& b) {
  return SameModel(a.technique, b.technique) && IsTraced(a) == IsTraced(b);
}

}  // namespace

void MeasuredErrors::Observe(const Setting& setting, double table_error, double measured_error) {
  if (!(table_error > 0.0) || !(measured_error > 0.0)) return;
  std::erase_if(found_, [&](const Found& found) { return SameLight(found.setting, setting); });
  found_.push_back({setting, measured_error / table_error});
}

double MeasuredErrors::FactorOf(const Setting& setting) const {
  const auto found = std::ranges::find_if(
      found_, [&](const Found& each) { return SameLight(each.setting, setting); });
  if (found != found_.end()) return found->factor;
  double logs = 0.0;
  int count = 0;
  for (const Found& each : found_) {
    if (IsTraced(each.setting) != IsTraced(setting)) continue;
    logs += std::log(each.factor);
    ++count;
  }
  return count == 0 ? 1.0 : std::exp(logs / count);
}

}  // namespace thunderhead::accuracy
