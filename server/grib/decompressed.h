// Decompresses GRIB files that are served as bz2 or gz.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "absl/status/statusor.h"
#include "base/byte_source.h"

namespace thunderhead::grib {

// Maximum size of any decompressed file.
inline constexpr std::uint64_t kMaxDecompressed_bytes = std::uint64_t{2} << 30;

// Returns the maximum size of a decompressed file that has `compressed_bytes` bytes in compressed
// form. It is 64 MiB plus 100 times these bytes, at most kMaxDecompressed_bytes. Weather data never
// shrink by so much, but a hostile file may expand to a thousand times its size.
std::uint64_t MaxDecompressed_bytes(std::uint64_t compressed_bytes);

// Returns whether these first bytes of a file are those of a bz2 or gz file.
bool BeginsCompressed(std::string_view start);

// Returns `file` itself if it is not compressed, otherwise its decompressed bytes in memory.
// Errors: DATA_LOSS if the file ends early or is damaged; INVALID_ARGUMENT if its contents do not
// begin with a GRIB message; FAILED_PRECONDITION if they exceed MaxDecompressed_bytes or
// `most_bytes`; RESOURCE_EXHAUSTED if the decompressor gets no memory. The size is checked while
// the contents grow. They need about as much memory as they have bytes.
absl::StatusOr<std::shared_ptr<const base::ByteSource>> Decompressed(
    std::shared_ptr<const base::ByteSource> file,
    std::uint64_t most_bytes = kMaxDecompressed_bytes);

}  // namespace thunderhead::grib
