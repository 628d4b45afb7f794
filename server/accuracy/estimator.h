// Reports the error of a picture. If paths were traced through the picture's pixels, the error is
// measured by them. Otherwise it is estimated from three inputs. These are the light model's error
// in the table of settings, the number of paths that corrected the light, and the difference from a
// picture with half the slices.
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

// The properties of a picture from which its error is estimated.
struct Evidence {
  std::int64_t traced_paths = 0;               // number of paths that corrected the picture's light
  std::optional<double> discretisation_error;  // from DiscretisationError
  std::optional<MeasuredError> measured;       // measured error of the whole picture
  bool is_last = false;                        // true if no better picture of the scene follows
};

// Returns the relative RMSE between a picture with half the slices (`half`) and the picture with
// all slices (`full`). Pixels have four values, of which the last is ignored. The result is an
// upper bound of the error of `full` caused by its finite number of slices, if this error decreases
// at first order or faster.
double DiscretisationError(const std::vector<float>& half, const std::vector<float>& full);

class Estimator {
 public:
  // Both arguments must outlive this object.
  Estimator(const OfferTables& tables, const MachineCosts& costs)
      : tables_(tables), costs_(costs) {}

  // Returns the report of a frame of `scene` with that quality. The settings of `scene` must be
  // final (Offers::Decide). Returns nothing if the tables do not contain its technique, mode and
  // transport.
  std::optional<AccuracyReport> Report(const scene::Scene& scene, const FrameQuality& quality,
                                       const Evidence& evidence) const;

  // Returns the number of paths that must be traced before an image of `scene` outside any session
  // is drawn, if the image waits for the path-traced correction. It is the smallest number with
  // which the requested error is kept, according to the tables and the measured `errors`. The
  // settings of `scene` must be final (Offers::Decide).
  std::int64_t PathsFor(const scene::Scene& scene, const MeasuredErrors& errors = {}) const;

 private:
  const OfferTables& tables_;
  const MachineCosts& costs_;
};

}  // namespace thunderhead::accuracy
