#include "gateway/byte_range.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/strip.h"
#include "base/digits.h"

namespace thunderhead::gateway {

ByteRange RangeOf(std::string_view header, std::uint64_t file_bytes) {
  const ByteRange all{ByteRange::Asked::kAll, 0, file_bytes};
  absl::string_view text =
      absl::StripAsciiWhitespace(absl::string_view(header.data(), header.size()));
  if (!absl::ConsumePrefix(&text, "bytes=")) return all;
  const std::size_t dash = text.find('-');
  if (dash == absl::string_view::npos) return all;
  const std::string_view first(text.data(), dash);
  const std::string_view last(text.data() + dash + 1, text.size() - dash - 1);
  // The numbers have no sign (RFC 9110, 14.1.2).
  const std::optional<std::uint64_t> from = base::ParseDigits(first);
  const std::optional<std::uint64_t> to = base::ParseDigits(last);
  if (first.empty()) {
    // A range without a first byte, such as "-500", asks for the last `to` bytes.
    if (!to.has_value()) return all;
    if (*to == 0 || file_bytes == 0) return {ByteRange::Asked::kNothingThere, 0, 0};
    const std::uint64_t bytes = std::min(*to, file_bytes);
    return {ByteRange::Asked::kPart, file_bytes - bytes, bytes};
  }
  if (!from.has_value()) return all;
  if (!last.empty() && (!to.has_value() || *to < *from)) return all;
  if (*from >= file_bytes) return {ByteRange::Asked::kNothingThere, 0, 0};
  const std::uint64_t end = to.has_value() ? std::min(*to, file_bytes - 1) : file_bytes - 1;
  return {ByteRange::Asked::kPart, *from, end - *from + 1};
}

}  // namespace thunderhead::gateway
