// Decompresses GRIB files that are served as bz2 or gz.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "absl/status/statusor.h"
#include "base/byte_source.h"

namespace thunderhead::grib {

// Maximum size of a decompressed file.
inline constexpr std::uint64_t kMaxDecompressed_bytes = std::uint64_t{2} << 30;

// Returns whether these first bytes of a file are those of a bz2 or gz file.
bool BeginsCompressed(std::string_view start);

// Returns `file` itself if it is not compressed, otherwise its decompressed bytes in memory.
// Errors: DATA_LOSS if the file ends early or is damaged; INVALID_ARGUMENT if its contents do not
// begin with a GRIB message; RESOURCE_EXHAUSTED if they exceed `most_bytes`.
absl::StatusOr<std::shared_ptr<const base::ByteSource>> Decompressed(
    std::shared_ptr<const base::ByteSource> file,
    std::uint64_t most_bytes = kMaxDecompressed_bytes);

}  // namespace thunderhead::grib
