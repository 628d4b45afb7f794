#include "grib/listing.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "base/byte_source.h"

namespace thunderhead::grib {
namespace {

// The number of bytes that are read from the end of a listing. They hold the lines of the last
// messages, because a line has fewer than 200 characters.
constexpr std::uint64_t kTail_bytes = 4096;

// Returns the end of the file, or nothing if it cannot be read.
std::string TailOf(const std::string& path) {
  std::error_code error;
  if (std::filesystem::symlink_status(path, error).type() != std::filesystem::file_type::regular) {
    return "";
  }
  const auto file = base::OpenBytes(path);
  if (!file.ok()) return "";
  const std::uint64_t size = (*file)->Size_bytes();
  std::string tail(std::min(size, kTail_bytes), '\0');
  const bool is_read =
      (*file)->Read(size - tail.size(), std::as_writable_bytes(std::span(tail))).ok();
  return is_read ? tail : "";
}

// Reads the offset from a line "number:offset:date:name:level:time:". The number of a field that
// shares its message with others is "number.n". Returns false for any other line.
bool ReadOffset(absl::string_view line, std::uint64_t& offset) {
  const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 2));
  double number = 0.0;
  return parts.size() == 3 && absl::SimpleAtod(parts[0], &number) &&
         absl::SimpleAtoi(parts[1], &offset);
}

}  // namespace

absl::Status CheckListing(const std::string& path, std::uint64_t size_bytes) {
  const std::string listing = path + ".idx";
  const std::string tail = TailOf(listing);
  std::uint64_t last = 0;
  for (const absl::string_view line : absl::StrSplit(tail, '\n')) {
    std::uint64_t offset = 0;
    if (ReadOffset(line, offset)) last = std::max(last, offset);
  }
  if (last == 0 || last < size_bytes) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(
      path, ": ends at byte ", size_bytes, ", but ", listing, " names a message at byte ", last,
      "; it was cut short: copy it again, or remove the .idx file if it belongs to another file"));
}

}  // namespace thunderhead::grib
