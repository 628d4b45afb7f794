// The ratio of frame times on this machine to those in a table. Plain values.
#pragma once

#include <map>
#include <string_view>
#include <tuple>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// Ratios of measured to tabulated time for each drawn setting, for each technique and for the
// machine. The most specific known ratio applies.
class TableCorrection {
 public:
  // Records that a frame of `setting` took `measured_ms`, with `table_ms` in the table.
  void Observe(const Setting& setting, double table_ms, double measured_ms);
  double Factor(const Setting& setting) const;
  // Returns true if a frame of that setting was observed.
  bool Knows(const Setting& setting) const;

 private:
  // A running mean of logarithms, because times scatter by factors.
  struct Mean {
    double log_factor = 0.0;
    int count = 0;

    void Follow(double log_measured);
  };
  // Names of technique, mode and transport; the number of slices; the image scale.
  using Key = std::tuple<std::string_view, std::string_view, std::string_view, int, double>;
  static Key KeyOf(const Setting& setting);

  std::map<Key, Mean> settings_;
  std::map<std::string_view, Mean> techniques_;
  Mean machine_;
};

}  // namespace thunderhead::accuracy
