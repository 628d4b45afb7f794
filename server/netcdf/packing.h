// How a variable's stored values become numbers: signs, scale, offset, and codes for missing
// values. The functions of this file call netCDF-C, so the caller must hold NetcdfLock.
#pragma once

#include <limits>
#include <vector>

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
  // If above zero, it is added to values below zero, because they are meant without a sign. If
  // below zero, it is added to values of the upper half of their range, because they are meant with
  // one.
  double wrap = 0.0;

  bool PlainFloat() const { return floats && scale == 1.0 && offset == 0.0; }
};

// Reads the attributes scale_factor, add_offset, _FillValue, missing_value, valid_min, valid_max,
// valid_range and _Unsigned.
Packing PackingOf(int group, int variable);

// Returns the numbers of an attribute, or an empty array if it is absent or a text.
std::vector<double> NumbersOf(int group, int variable, const char* attribute);

// Returns the unpacked value, or NaN if it is missing.
double Unpacked(double stored, const Packing& packing);

// Returns the value as a float, and 0 for a subnormal one.
float FlushedFloat(double value);

// Replaces missing values by NaN and subnormal ones by 0, in place. For Packing::PlainFloat().
void CleanPlainFloats(const Packing& packing, std::vector<float>& values);

}  // namespace thunderhead::netcdf
