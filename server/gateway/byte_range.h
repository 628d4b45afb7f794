// The part of a file that a request asks for (RFC 9110, 14). It depends on no socket and no file.
#pragma once

#include <cstdint>
#include <string_view>

namespace thunderhead::gateway {

struct ByteRange {
  enum class Asked { kAll, kPart, kNothingThere };
  Asked asked = Asked::kAll;
  std::uint64_t first = 0;
  std::uint64_t bytes = 0;
};

// Returns the part of a file of `file_bytes` bytes that a Range header asks for. For a header that
// is empty, malformed or has several parts, it returns the whole file, as HTTP permits.
ByteRange RangeOf(std::string_view header, std::uint64_t file_bytes);

}  // namespace thunderhead::gateway
