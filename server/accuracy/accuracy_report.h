// The report about a picture's error. Every error is the relative root mean square error (RMSE) of
// linear radiance compared with the Monte Carlo reference.
#pragma once

#include <optional>
#include <string>

#include "accuracy/error_estimate.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

// The reason why a picture does not reach the requested accuracy or speed.
struct Unmet {
  enum class Code { kErrorOutOfReach, kTimeOutOfReach } code = Code::kErrorOutOfReach;
  std::string message;  // text with the requested limit and the nearest value that can be reached

  bool operator==(const Unmet&) const = default;
};

struct AccuracyReport {
  scene::Technique technique;         // technique and settings of the picture at full quality
  int slices = 0;                     // number of slices of this picture; for metaballs, number of
                                      // balls
  double image_scale = 1.0;           // image scale of this picture
  std::optional<double> expected_ms;  // predicted time of a frame at full quality on this machine
  double model_error = 0.0;           // error of the light model, from the measured table of
                                      // settings
  std::optional<double> discretisation_error;
  double estimated_error = 0.0;           // the measured error or, without a measurement, both
                                          // parts above combined
  std::optional<MeasuredError> measured;  // error that was measured by tracing paths through the
                                          // picture's pixels
  std::optional<Unmet> unmet;

  bool operator==(const AccuracyReport&) const = default;
};

}  // namespace thunderhead::accuracy
