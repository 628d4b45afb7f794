// Convergence of pictures with the number of slices, for each transport. The error of linear
// radiance is measured against a picture of the same transport with many more slices. The order of
// convergence is fitted to the errors. measure/trade.h measures the error of the converged picture.
// The functions use the current GL context.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/named_settings.h"
#include "measure/machine.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

struct SlicePoint {
  int slices = 0;
  double relative_rmse = 0.0;
};

struct SliceCurve {
  accuracy::Named<scene::Transport> transport;
  std::vector<SlicePoint> points;
  double order = 0.0;  // exponent of a power law through the points: error ~ slices^-order
};

// Draws `scene` with its technique, mode and size, with 8 to 256 slices and each transport.
absl::StatusOr<std::vector<SliceCurve>> MeasureSliceConvergence(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::function<void(double share)>& progress);

// Returns the exponent of the power law that fits the points best (least squares of the
// logarithms). Points whose error is within ten rounding errors of the frame's half floats are
// ignored if at least two other points remain.
double OrderOf(const std::vector<SlicePoint>& points);

std::string ToTable(const std::vector<SliceCurve>& curves);
std::string ToJson(const Machine& machine, const std::vector<SliceCurve>& curves);
std::string ToCsv(const std::vector<SliceCurve>& curves);
std::string ToSvg(const std::string& title, const std::vector<SliceCurve>& curves);

}  // namespace thunderhead::measure
