// Tells the error of a picture: as measured by paths that were traced through it, or, where there
// are none yet, from everything that is known without the reference: the row of its setting in the
// table (the error of the light model), the paths that corrected its light, and how much half the
// slices change it. Plain values.
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

// Properties of a picture that its error is estimated from.
struct Evidence {
  std::int64_t traced_paths = 0;               // that corrected its light
  std::optional<double> discretisation_error;  // by DiscretisationError
  std::optional<MeasuredError> measured;       // of the whole picture
  bool is_last = false;                        // no better picture of the scene follows
};

// Relative RMSE between a picture with half the slices and the full one, four values a pixel of
// which the last does not count. No less than the full one's distance from endlessly many slices,
// where that falls with their number at first order or faster.
double DiscretisationError(const std::vector<float>& half, const std::vector<float>& full);

class Estimator {
 public:
  // Both must outlive it.
  Estimator(const OfferTables& tables, const MachineCosts& costs)
      : tables_(tables), costs_(costs) {}

  // The report of a frame of `scene` (decided) with that quality; none where the tables do not know
  // its technique, mode and transport.
  std::optional<AccuracyReport> Report(const scene::Scene& scene, const FrameQuality& quality,
                                       const Evidence& evidence) const;

  // The paths that a picture of `scene` (decided) outside any session waits for, if it waits: the
  // fewest with which it keeps within the error that it asks for, by the tables and what measuring
  // its pictures has told of them.
  std::int64_t PathsFor(const scene::Scene& scene, const MeasuredErrors& errors = {}) const;

 private:
  const OfferTables& tables_;
  const MachineCosts& costs_;
};

}  // namespace thunderhead::accuracy
