#include "gateway/byte_range.h"

#include <algorithm>
#include <boost/beast/http/error.hpp>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"

namespace thunderhead::gateway {

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
    // The last `to` bytes.
    if (!absl::SimpleAtoi(last, &to)) return all;
    if (to == 0 || file_bytes == 0) return {ByteRange::Asked::kNothingThere, 0, 0};
    to = std::min(to, file_bytes);
    return {ByteRange::Asked::kPart, file_bytes - to, to};
  }
  if (!absl::SimpleAtoi(first, &from)) return all;
  if (!last.empty() && (!absl::SimpleAtoi(last, &to) || to < from)) return all;
  if (from >= file_bytes) return {ByteRange::Asked::kNothingThere, 0, 0};
  to = last.empty() ? file_bytes - 1 : std::min(to, file_bytes - 1);
  return {ByteRange::Asked::kPart, from, to - from + 1};
}

boost::optional<std::pair<FileRangeBody::writer::const_buffers_type, bool>>
FileRangeBody::writer::get(boost::system::error_code& error) {
  error = {};
  if (left_ == 0) return boost::none;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left_, buffer_.size()));
  const std::size_t bytes = body_.file.read(buffer_.data(), wanted, error);
  if (error) return boost::none;
  if (bytes == 0) {
    // The file was cut off meanwhile.
    error = boost::beast::http::make_error_code(boost::beast::http::error::short_read);
    return boost::none;
  }
  left_ -= bytes;
  return std::pair{const_buffers_type(buffer_.data(), bytes), left_ > 0};
}

}  // namespace thunderhead::gateway
