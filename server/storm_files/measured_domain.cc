#include "storm_files/measured_domain.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::storm_files {
namespace {

using volume::EarthPlace;
using volume::MapProjection;

// The number of places along each axis at which distances are measured.
constexpr int kSamples = 65;
// A latitude or longitude that is stored as a float is known to a metre. Distances between such
// places are measured over this length.
constexpr double kMeasured_m = 4000.0;

// Returns up to kSamples numbers from `first` to `last`. They are integers if `whole`.
std::vector<double> Spread(double first, double last, int most, bool whole) {
  const int count = std::clamp(most, 1, kSamples);
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    const double at = count == 1 ? 0.5 * (first + last) : first + (last - first) * i / (count - 1);
    numbers.push_back(whole ? std::round(at) : at);
  }
  return numbers;
}

}  // namespace

absl::Status BeyondTheMap() {
  return absl::InvalidArgumentError(
      "columns lie beyond the edge of their map projection; correct its parameters");
}

// Returns the number of columns over which the distance between neighbours is measured.
int MeasuredDomain::Span(int axis) const {
  if (model_.IsProjected()) return 1;
  const glm::dvec2 at = glm::floor(model_.MiddlePosition());
  glm::dvec2 next = at;
  next[axis] += 1.0;
  const double step_m = ShortDistance_m(*model_.PlaceAt(at), *model_.PlaceAt(next), earth_);
  const double span = std::ceil(kMeasured_m / std::max(step_m, 1.0));
  return static_cast<int>(std::clamp(span, 1.0, model_.Count()[axis] - 1.0));
}

absl::Status MeasuredDomain::VisitSteps(int axis, const VisitStep& visit) const {
  const int span = Span(axis);
  const int other = 1 - axis;
  const bool whole = !model_.IsProjected();
  const glm::ivec2& count = model_.Count();
  const double first = whole ? 0.0 : -0.5;
  for (const double across : Spread(0.0, count[other] - 1.0, count[other], whole)) {
    for (const double along :
         Spread(first, first + count[axis] - (whole ? 1.0 + span : 1.0), count[axis], whole)) {
      glm::dvec2 from;
      from[axis] = along;
      from[other] = across;
      glm::dvec2 to = from;
      to[axis] += span;
      const std::optional<EarthPlace> a = model_.PlaceAt(from);
      const std::optional<EarthPlace> b = model_.PlaceAt(to);
      if (!a.has_value() || !b.has_value()) return BeyondTheMap();
      visit(*a, *b, span);
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<StepLengths> MeasuredDomain::StepsAlong(int axis, const MapProjection& local) const {
  StepLengths distances;
  double sum_m = 0.0;
  int samples = 0;
  const auto measure = [&](const EarthPlace& a, const EarthPlace& b, int span) {
    const double distance_m = ShortDistance_m(a, b, earth_) / span;
    distances.shortest_m = std::min(distances.shortest_m, distance_m);
    distances.longest_m = std::max(distances.longest_m, distance_m);
    sum_m += distance_m;
    ++samples;
    const std::optional<glm::dvec2> from_m = local.WorldOf(a);
    const std::optional<glm::dvec2> to_m = local.WorldOf(b);
    if (!from_m.has_value() || !to_m.has_value()) return;
    const glm::dvec2 way_m = *to_m - *from_m;
    const double turn = axis == 0 ? std::atan2(way_m.y, way_m.x) : std::atan2(-way_m.x, way_m.y);
    distances.largest_turn = std::max(distances.largest_turn, std::abs(turn));
  };
  THUNDERHEAD_RETURN_IF_ERROR(VisitSteps(axis, measure));
  distances.mean_m = sum_m / samples;
  if (!std::isfinite(distances.mean_m)) return BeyondTheMap();
  if (distances.mean_m > 0.0) return distances;
  return absl::InvalidArgumentError(
      absl::StrCat("all columns along ", axis == 0 ? "x" : "y",
                   " are at the same place; correct their latitudes and longitudes"));
}

absl::StatusOr<MapScale> MeasuredDomain::ScaleOf(const MapProjection& map) const {
  MapScale scale;
  bool is_on_map = true;
  const auto measure = [&](const EarthPlace& a, const EarthPlace& b, int /*span*/) {
    const std::optional<glm::dvec2> from_m = map.WorldOf(a);
    const std::optional<glm::dvec2> to_m = map.WorldOf(b);
    const double distance_m = ShortDistance_m(a, b, earth_);
    is_on_map = is_on_map && from_m.has_value() && to_m.has_value();
    if (!is_on_map || distance_m == 0.0) return;
    const double ratio = glm::distance(*from_m, *to_m) / distance_m;
    scale.least = std::min(scale.least, ratio);
    scale.largest = std::max(scale.largest, ratio);
  };
  for (const int axis : {0, 1}) THUNDERHEAD_RETURN_IF_ERROR(VisitSteps(axis, measure));
  if (!is_on_map) return BeyondTheMap();
  return scale;
}

absl::StatusOr<double> MeasuredDomain::Reach_m(const EarthPlace& middle) const {
  double reach_m = 0.0;
  for (const double x : Spread(-0.5, model_.Count().x - 0.5, model_.Count().x + 1, false)) {
    for (const double y : Spread(-0.5, model_.Count().y - 0.5, model_.Count().y + 1, false)) {
      const std::optional<EarthPlace> place = model_.PlaceAt({x, y});
      if (!place.has_value()) return BeyondTheMap();
      reach_m = std::max(reach_m, GreatCircle_m(middle, *place, MeanRadius_m(earth_)));
    }
  }
  return reach_m;
}

}  // namespace thunderhead::storm_files
