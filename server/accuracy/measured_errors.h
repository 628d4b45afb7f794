// Corrects the errors in the tables by measured errors of a scene's pictures.
#pragma once

#include <vector>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// The ratios of the measured errors of a scene's pictures to the errors in the tables. There is a
// separate ratio for each measured technique and light model, and for settings with and without
// path-traced correction.
class MeasuredErrors {
 public:
  // Records that a picture with `setting` has the error `measured_error`, where the table has
  // `table_error`.
  void Observe(const Setting& setting, double table_error, double measured_error);
  // Returns the ratio for `setting`. If it was not measured, returns the geometric mean of the
  // measured ratios of settings that are likewise with or without path-traced correction. This is a
  // good guess, because a scene for which one light model's error in the table is wrong is probably
  // unusual for the other models, too. Returns 1 if nothing was measured.
  double FactorOf(const Setting& setting) const;

 private:
  struct Found {
    Setting setting;
    double factor = 1.0;
  };
  std::vector<Found> found_;
};

}  // namespace thunderhead::accuracy
