// Corrections of the tables' errors by measurements of a scene's pictures. A plain value.
#pragma once

#include <vector>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// The ratios of measured errors of a scene's pictures to the tables' errors. There is one ratio for
// each measured technique and light model, with and without traced light.
class MeasuredErrors {
 public:
  // Records that pictures of `setting`, whose error is `table_error` in the table, have
  // `measured_error`.
  void Observe(const Setting& setting, double table_error, double measured_error);
  // Returns the ratio for a setting. If it was not measured, returns the geometric mean of the
  // measured ones with, or without, traced light. If the tables are wrong about one light model,
  // they are probably wrong about others as well. 1 if nothing was measured.
  double FactorOf(const Setting& setting) const;

 private:
  struct Found {
    Setting setting;
    double factor = 1.0;
  };
  std::vector<Found> found_;
};

}  // namespace thunderhead::accuracy
