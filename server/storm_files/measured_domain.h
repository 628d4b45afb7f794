// Measures a model's domain: the distances between neighbouring columns, the scale of a flat map,
// and how far the domain reaches. Distances are measured at up to 65 places along each axis.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "storm_files/model_columns.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {

// Columns count as even if no distance differs from the mean distance by more than this share.
inline constexpr double kEven = 0.005;

// Returns INVALID_ARGUMENT, which says that columns lie beyond the edge of their map.
absl::Status BeyondTheMap();

// Distances between neighbouring columns along one axis.
struct StepLengths {
  double shortest_m = std::numeric_limits<double>::infinity();
  double longest_m = 0.0;
  double mean_m = 0.0;
  double largest_turn = 0.0;  // the largest deviation of the axis from its compass direction, in
                              // radians

  bool AreEven() const {
    return shortest_m >= (1.0 - kEven) * mean_m && longest_m <= (1.0 + kEven) * mean_m;
  }
};

// Lengths on a map divided by true lengths: the smallest and the largest ratio, and 1.
struct MapScale {
  double least = 1.0;
  double largest = 1.0;

  double Error() const { return std::max(largest - 1.0, 1.0 - least); }
};

class MeasuredDomain {
 public:
  // Receives two places that are `span` columns apart along an axis.
  using VisitStep =
      std::function<void(const volume::EarthPlace& from, const volume::EarthPlace& to, int span)>;

  // `model` must outlive this object.
  MeasuredDomain(const ModelColumns& model, const volume::EarthFigure& earth)
      : model_(model), earth_(earth) {}

  // Calls `visit` with steps along an axis (0 is x, 1 is y) all over the domain. Returns
  // INVALID_ARGUMENT if a column is beyond the edge of the model's map.
  absl::Status VisitSteps(int axis, const VisitStep& visit) const;

  // Measures the distances along an axis. The deviation from the compass direction is measured on
  // the map `local`. Returns INVALID_ARGUMENT if all columns along the axis are at one place, and
  // the errors of VisitSteps.
  absl::StatusOr<StepLengths> StepsAlong(int axis, const volume::MapProjection& local) const;

  // Measures the scale of a map in the domain. Returns INVALID_ARGUMENT if an edge of the map is
  // within the domain.
  absl::StatusOr<MapScale> ScaleOf(const volume::MapProjection& map) const;

  // Returns the distance of `middle` from the farthest edge of the domain.
  absl::StatusOr<double> Reach_m(const volume::EarthPlace& middle) const;

 private:
  int Span(int axis) const;

  const ModelColumns& model_;
  const volume::EarthFigure earth_;
};

}  // namespace thunderhead::storm_files
