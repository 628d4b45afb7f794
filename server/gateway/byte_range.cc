#include "gateway/byte_range.h"

#include <algorithm>
#include <cstddef>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"

namespace thunderhead::gateway {
namespace {

// Reads a number of digits without a sign (RFC 9110, 14.1.2).
bool ReadDigits(absl::string_view text, std::uint64_t& number) {
  return std::all_of(text.begin(), text.end(), absl::ascii_isdigit) &&
         absl::SimpleAtoi(text, &number);
}

}  // namespace

ByteRange RangeOf(std::string_view header, std::uint64_t file_bytes) {
  const ByteRange all{ByteRange::Asked::kAll, 0, file_bytes};
  absl::string_view text =
      absl::StripAsciiWhitespace(absl::string_view(header.data(), header.size()));
  if (!absl::ConsumePrefix(&text, "bytes=")) return all;
  const std::size_t dash = text.find('-');
  if (dash == absl::string_view::npos) return all;
  const absl::string_view first = text.substr(0, dash);
  const absl::string_view last = text.substr(dash + 1);
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  if (first.empty()) {
    // A range without a first byte, such as "-500", asks for the last `to` bytes.
    if (!ReadDigits(last, to)) return all;
    if (to == 0 || file_bytes == 0) return {ByteRange::Asked::kNothingThere, 0, 0};
    to = std::min(to, file_bytes);
    return {ByteRange::Asked::kPart, file_bytes - to, to};
  }
  if (!ReadDigits(first, from)) return all;
  if (!last.empty() && (!ReadDigits(last, to) || to < from)) return all;
  if (from >= file_bytes) return {ByteRange::Asked::kNothingThere, 0, 0};
  to = last.empty() ? file_bytes - 1 : std::min(to, file_bytes - 1);
  return {ByteRange::Asked::kPart, from, to - from + 1};
}

}  // namespace thunderhead::gateway
