// Corrections of the tables' errors, by what was measured on a scene's pictures. A plain value.
#pragma once

#include <vector>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// How many times the error of the tables a scene's pictures have, for each technique and model of
// light that was measured, with traced light and without.
class MeasuredErrors {
 public:
  // Pictures of `setting`, for which the table says `table_error`, have `measured_error`.
  void Observe(const Setting& setting, double table_error, double measured_error);
  // Of one that was not measured, the geometric mean of those that were, with traced light or
  // without: where the tables are wrong about one model of light, they are likely to be wrong about
  // others as well. 1 where nothing was measured.
  double FactorOf(const Setting& setting) const;

 private:
  struct Found {
    Setting setting;
    double factor = 1.0;
  };
  std::vector<Found> found_;
};

}  // namespace thunderhead::accuracy
