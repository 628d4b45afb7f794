// Reports the error of a picture. It is measured by paths traced through the picture if there are
// any. Otherwise it is estimated without the reference. The estimate uses the setting's row in the
// table (the error of the light model), the paths that corrected its light, and the change with
// half the slices. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "accuracy/accuracy_report.h"
#include "accuracy/frame_quality.h"
#include "accuracy/machine_costs.h"
#include "accuracy/measured_errors.h"
#include "accuracy/offer_tables.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// Properties of a picture from which its error is estimated.
struct Evidence {
  std::int64_t traced_paths = 0;               // paths that corrected its light
  std::optional<double> discretisation_error;  // from DiscretisationError
  std::optional<MeasuredError> measured;       // of the whole picture
  bool is_last = false;                        // no better picture of the scene follows
};

// Returns the relative RMSE between a picture with half the slices and the full one. Pixels have
// four values, of which the last is ignored. It bounds the full picture's difference from
// infinitely many slices if that falls with their number at first order or faster.
double DiscretisationError(const std::vector<float>& half, const std::vector<float>& full);

class Estimator {
 public:
  // Both must outlive it.
  Estimator(const OfferTables& tables, const MachineCosts& costs)
      : tables_(tables), costs_(costs) {}

  // Returns the report of a frame of `scene` (decided) with that quality. None if the tables do not
  // cover its technique, mode and transport.
  std::optional<AccuracyReport> Report(const scene::Scene& scene, const FrameQuality& quality,
                                       const Evidence& evidence) const;

  // Returns the number of paths for which an image of `scene` (decided) outside any session waits,
  // if it waits. It is the smallest number that keeps the requested error, according to the tables
  // and the measured `errors`.
  std::int64_t PathsFor(const scene::Scene& scene, const MeasuredErrors& errors = {}) const;

 private:
  const OfferTables& tables_;
  const MachineCosts& costs_;
};

}  // namespace thunderhead::accuracy
