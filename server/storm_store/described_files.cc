#include "storm_store/described_files.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <new>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/slow_calls.h"

namespace thunderhead::storm_store {

std::size_t EndOfBatch(const std::vector<std::string>& paths, std::size_t first) {
  constexpr std::size_t kMostFiles = 50;
  constexpr std::uintmax_t kMost_bytes = 8 << 20;
  std::uintmax_t bytes = 0;
  std::size_t end = first;
  for (; end < paths.size() && end - first < kMostFiles; ++end) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(paths[end], error);
    if (error || size > kMost_bytes - bytes) break;
    bytes += size;
  }
  return std::max(end, first + 1);
}

std::vector<absl::StatusOr<storm_files::StormFile>> DescribeBatch(
    const std::vector<std::string>& paths, const storm_files::StormFormats& formats,
    std::chrono::milliseconds patience) {
  const base::SlowCall call(paths.front());
  std::vector<absl::StatusOr<storm_files::StormFile>> files;
  try {
    files = formats.DescribeEach(paths, patience);
  } catch (const std::bad_alloc&) {
    files.assign(paths.size(),
                 absl::ResourceExhaustedError(absl::StrCat(
                     paths.front(),
                     ": describing it needs more memory than there is; cut or split the "
                     "file, or copy it again if it is damaged")));
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!files[i].ok() || files[i]->device != 0) continue;
    const std::optional<base::FileStamp> stamp = base::StampOf(paths[i]);
    if (!stamp.has_value()) continue;
    files[i]->device = stamp->device;
    files[i]->modified_ns = stamp->modified_ns;
  }
  return files;
}

absl::StatusOr<storm_files::StormFile> DescribeFile(const std::string& path,
                                                    const storm_files::StormFormats& formats) {
  return DescribeBatch({path}, formats, storm_files::kLongestDescription).front();
}

std::vector<absl::StatusOr<storm_files::StormFile>> DescribeInBatches(
    const std::vector<std::string>& paths, const storm_files::StormFormats& formats,
    const std::function<bool()>& before) {
  const absl::StatusOr<storm_files::StormFile> stopped =
      absl::CancelledError("the search was stopped");
  std::vector<absl::StatusOr<storm_files::StormFile>> described;
  for (std::size_t first = 0, last = 0; first < paths.size(); first = last) {
    last = EndOfBatch(paths, first);
    if (!before()) break;
    const auto begin = paths.begin();
    std::ranges::move(DescribeBatch({begin + static_cast<std::ptrdiff_t>(first),
                                     begin + static_cast<std::ptrdiff_t>(last)},
                                    formats, storm_files::kLongestDescription),
                      std::back_inserter(described));
    for (std::size_t i = first; i < last; ++i) {
      if (!absl::IsAborted(described[i].status())) continue;
      described[i] = before() ? DescribeFile(paths[i], formats) : stopped;
    }
  }
  described.resize(paths.size(), stopped);
  return described;
}

}  // namespace thunderhead::storm_store
