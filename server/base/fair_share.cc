#include "base/fair_share.h"

#include <algorithm>
#include <limits>

namespace thunderhead::base {

std::string FairShare::Next(const std::vector<std::string>& waiting) {
  return *Next(waiting, [](const std::string&) { return true; });
}

std::optional<std::string> FairShare::Next(const std::vector<std::string>& waiting,
                                           const std::function<bool(const std::string&)>& may) {
  double least_ms = std::numeric_limits<double>::infinity();
  for (const std::string& id : waiting) {
    const auto known = used_ms_.find(id);
    if (known != used_ms_.end()) least_ms = std::min(least_ms, known->second);
  }
  if (least_ms == std::numeric_limits<double>::infinity()) least_ms = 0.0;
  std::map<std::string, double> used_ms;
  std::optional<std::string> next;
  double next_ms = std::numeric_limits<double>::infinity();
  for (const std::string& id : waiting) {
    const auto known = used_ms_.find(id);
    const double ms = known != used_ms_.end() ? known->second : least_ms;
    used_ms[id] = ms;
    if (ms >= next_ms || !may(id)) continue;
    next = id;
    next_ms = ms;
  }
  used_ms_ = std::move(used_ms);
  return next;
}

void FairShare::Used(const std::string& id, double milliseconds) {
  const auto known = used_ms_.find(id);
  if (known != used_ms_.end()) known->second += milliseconds;
}

}  // namespace thunderhead::base
