// Converts between units of measurement with UDUNITS, by the texts of files' `units` attributes.
// UDUNITS reads its database from files, so a process that may open no file must call LoadUnits
// before. All functions are safe from any thread.
#pragma once

#include <optional>
#include <string_view>

#include "absl/status/status.h"

namespace thunderhead::storm_files {

// Loads the database of units. Later calls do nothing. Returns FAILED_PRECONDITION if the database
// cannot be read.
absl::Status LoadUnits();

// A value in the wanted unit is `scale` times the value in the file, plus `offset`.
struct UnitConversion {
  double scale = 1.0;
  double offset = 0.0;

  double operator()(double value) const { return value * scale + offset; }
};

// Returns the conversion from `from`, a text of a file, to `to`, a text of this program. Returns
// nothing if `from` is empty or is no unit of the same dimension, or if its scale is 0, below 1e-30
// or above 1e30 ("1e300 kg m-3"). Returns nothing for grains ("gr/kg"), which can mean grams. An
// angle is not converted to a number, although both have no dimension.
std::optional<UnitConversion> ConversionOf(std::string_view from, std::string_view to);

}  // namespace thunderhead::storm_files
