// Decodes the values of a field, with ecCodes.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"
#include "grib/index.h"

namespace thunderhead::grib {

// Makes ecCodes read its definition files, by decoding a small field of each packing. Afterwards
// DecodeValues opens no file. Returns FAILED_PRECONDITION if the files are not installed.
absl::Status PrepareBeforeConfinement();

// Returns the values of `field` of `file`, which was indexed by ReadIndex, in the order of the
// file's scanning mode. Missing values are NaN. Safe to call from several threads. Errors name the
// file: INVALID_ARGUMENT for a packing that is not supported; DATA_LOSS for damaged data;
// RESOURCE_EXHAUSTED if the values do not fit into memory or are more than 200 million.
absl::StatusOr<std::vector<float>> DecodeValues(const base::ByteSource& file, const Field& field);

}  // namespace thunderhead::grib
