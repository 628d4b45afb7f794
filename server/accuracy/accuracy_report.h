// The estimated error of a picture. Errors are relative RMSE of linear radiance against the
// reference.
#pragma once

#include <optional>
#include <string>

#include "accuracy/error_estimate.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// The reason why a requested accuracy or speed is not reached.
struct Unmet {
  enum class Code { kErrorOutOfReach, kTimeOutOfReach } code = Code::kErrorOutOfReach;
  std::string message;  // the limit, and the nearest value that can be reached

  bool operator==(const Unmet&) const = default;
};

struct AccuracyReport {
  scene::Technique technique;         // with its settings at full quality
  int slices = 0;                     // of this picture; for metaballs their number
  double image_scale = 1.0;           // of this picture
  std::optional<double> expected_ms;  // of a frame at full quality, on this machine
  double model_error = 0.0;           // from the table
  std::optional<double> discretisation_error;
  double estimated_error = 0.0;           // the measured error; without one, both parts together
  std::optional<MeasuredError> measured;  // measured by tracing paths through the picture
  std::optional<Unmet> unmet;

  bool operator==(const AccuracyReport&) const = default;
};

}  // namespace thunderhead::accuracy
