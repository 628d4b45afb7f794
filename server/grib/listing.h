// Checks a GRIB file against the listing (.idx) that weather centres serve with it. A file that
// was cut short between two messages looks complete, but its listing also names the missing
// messages.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace thunderhead::grib {

// Returns DATA_LOSS if the listing `path`.idx names a message that begins at or beyond the end of
// the file `path`, which has `size_bytes` bytes. Returns OK if there is no listing, or if it cannot
// be read. A symbolic link is not followed.
absl::Status CheckListing(const std::string& path, std::uint64_t size_bytes);

}  // namespace thunderhead::grib
