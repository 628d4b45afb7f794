// Mutates GRIB2 files by their structure: the numbers in a section's known places, templates,
// widths of packed values, bitmaps, lengths, and the order of sections and messages. The lengths of
// most results are correct, so that changes reach the code behind the checks of lengths.
#pragma once

#include <cstdint>
#include <string>

namespace thunderhead::testing {

// Returns a mutation of `file`, which depends only on the arguments. The file need not be valid.
// The result may be compressed as gz or bz2.
std::string MutateGrib(const std::string& file, std::uint64_t seed);

}  // namespace thunderhead::testing
