// The ratio of frame times on this machine to the frame times in a table.
#pragma once

#include <map>
#include <string_view>
#include <tuple>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// The ratios of measured times to the times in a table: for each drawn setting, for each technique
// and for the whole machine. For a setting, the most specific known ratio is used.
class TableCorrection {
 public:
  // Records that a frame with `setting` took `measured_ms`, where the table has `table_ms`.
  void Observe(const Setting& setting, double table_ms, double measured_ms);
  double Factor(const Setting& setting) const;
  // Returns true if a frame of that setting was observed.
  bool Knows(const Setting& setting) const;

 private:
  // A running mean of the logarithms of ratios. Logarithms are used because times vary by factors.
  struct Mean {
    double log_factor = 0.0;
    int count = 0;

    void Follow(double log_measured);
  };
  // The names of technique, mode and transport, the number of slices, and the image scale.
  using Key = std::tuple<std::string_view, std::string_view, std::string_view, int, double>;
  static Key KeyOf(const Setting& setting);

  std::map<Key, Mean> settings_;
  std::map<std::string_view, Mean> techniques_;
  Mean machine_;
};

}  // namespace thunderhead::accuracy
