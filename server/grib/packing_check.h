// Checks the packed data of a field before ecCodes sees them. ecCodes trusts the numbers in a
// message. A damaged or hostile file can thus make it end the process, or allocate any memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::grib {

// The packings that are read (code table 5.0).
enum class Packing {
  kSimple = 0,
  kComplex = 2,
  kSpatialDifferencing = 3,
  kIeee = 4,
  kJpeg2000 = 40,
  kPng = 41,
  kCcsds = 42,
  kSecondOrder = 50002,
};

// The data of one packed field. Each span is a whole section of the message, including its length
// and its section number.
struct PackedField {
  std::uint64_t points = 0;            // number of the grid's points, by section 3
  std::span<const std::byte> packing;  // section 5
  std::span<const std::byte> bitmap;   // section 6 that contains the bitmap; empty if there is none
  std::span<const std::byte> data;     // section 7
};

// Returns the packing of section 5, or INVALID_ARGUMENT if it is not supported. The error does not
// name the file.
absl::StatusOr<Packing> PackingOf(std::span<const std::byte> packing);

// Returns DATA_LOSS if the numbers of the sections contradict one another, or the error of
// PackingOf. The error does not name the file.
absl::Status CheckPacked(const PackedField& field);

}  // namespace thunderhead::grib
