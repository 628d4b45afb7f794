// The estimated error of a picture. Errors are relative RMSE of linear radiance against the
// reference.
#pragma once

#include <optional>
#include <string>

#include "accuracy/error_estimate.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// Why an asked-for accuracy or speed is not reached.
struct Unmet {
  enum class Code { kErrorOutOfReach, kTimeOutOfReach } code = Code::kErrorOutOfReach;
  std::string message;  // the limit, and the nearest that is reached

  bool operator==(const Unmet&) const = default;
};

struct AccuracyReport {
  scene::Technique technique;         // with its settings at full quality
  int slices = 0;                     // of this picture; or metaballs
  double image_scale = 1.0;           // of this picture
  std::optional<double> expected_ms;  // of a frame at full quality, on this machine
  double model_error = 0.0;           // by the table
  std::optional<double> discretisation_error;
  double estimated_error = 0.0;           // as measured; until then both parts together
  std::optional<MeasuredError> measured;  // by paths traced through the picture
  std::optional<Unmet> unmet;

  bool operator==(const AccuracyReport&) const = default;
};

}  // namespace thunderhead::accuracy
