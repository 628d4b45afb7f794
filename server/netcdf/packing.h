// How a variable's stored values become numbers: signs, scale, offset, and codes for missing
// values. PackingOf and NumbersOf call netCDF-C, so their callers must hold NetcdfLock.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"

namespace thunderhead::netcdf {

// The packing attributes of a variable. The fill values and the valid range are packed values, like
// the stored values.
struct Packing {
  bool floats = true;  // true if the stored values are floats
  double scale = 1.0;
  double offset = 0.0;
  double fill = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> missing;
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  // If above zero, it is added to values below zero, because the values are meant to be unsigned.
  // If below zero, it is added to values in the upper half of the type's range, because the values
  // are meant to be signed.
  double wrap = 0.0;

  bool PlainFloat() const { return floats && scale == 1.0 && offset == 0.0; }
};

// Reads the attributes scale_factor, add_offset, _FillValue, missing_value, valid_min, valid_max,
// valid_range and _Unsigned. Returns INVALID_ARGUMENT, with the attribute's name and the remedy, if
// scale_factor or add_offset is not one finite number, or if a limit of the valid range is NaN.
absl::StatusOr<Packing> PackingOf(int group, int variable);

// Returns the numbers of an attribute, or an empty array if it is absent or a text.
std::vector<double> NumbersOf(int group, int variable, const char* attribute);

// Returns the unpacked value, or NaN if it is missing.
double Unpacked(double stored, const Packing& packing);

// The functions Unpack and CleanPlainFloats replace missing values by NaN, and subnormal ones by 0.
// Codes for missing values are those that the file declares, the default fill value of netCDF, and
// one undeclared number from 1e30 to 1e37, which many models write. All other values with a
// magnitude of at least 1e30 are errors of the file, because no quantity in a storm is that large.
// The functions replace them by NaN too, and return one of them, or nothing if there are none.

// Unpacks `packed` into `values`, which has the same length.
std::optional<double> Unpack(absl::Span<const double> packed, const Packing& packing,
                             absl::Span<float> values);

// Changes `values` in place. packing.PlainFloat() must be true.
std::optional<double> CleanPlainFloats(const Packing& packing, std::vector<float>& values);

}  // namespace thunderhead::netcdf
