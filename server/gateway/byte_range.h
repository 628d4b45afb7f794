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

// Returns the part of a file of this size that a Range header asks for. The result is the whole
// file for a header that is empty, has several parts or is malformed; HTTP permits this.
ByteRange RangeOf(std::string_view header, std::uint64_t file_bytes);

}  // namespace thunderhead::gateway
