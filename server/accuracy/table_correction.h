// How much longer frames take on this machine than a table says. Plain values.
#pragma once

#include <map>
#include <string_view>
#include <tuple>

#include "accuracy/setting.h"

namespace thunderhead::accuracy {

// Ratios of measured to tabulated time: of each setting that was drawn, each technique and the
// machine. The most specific that is known counts.
class TableCorrection {
 public:
  // A frame of `setting` took `measured_ms` where the table says `table_ms`.
  void Observe(const Setting& setting, double table_ms, double measured_ms);
  double Factor(const Setting& setting) const;
  // True if a frame of that setting was observed.
  bool Knows(const Setting& setting) const;

 private:
  // A running mean of logarithms: times scatter by factors.
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
