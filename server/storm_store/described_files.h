// Describes files for a search, small files in batches.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "storm_files/storm_file.h"
#include "storm_files/storm_format.h"

namespace thunderhead::storm_store {

// Returns the end of the batch of files that begins with paths[first]. A reader gets a batch in
// memory, so its size is limited, and a file that is larger is a batch alone.
std::size_t EndOfBatch(const std::vector<std::string>& paths, std::size_t first);

// Describes a file by the formats. Returns an error if the file's metadata exhaust the memory.
absl::StatusOr<storm_files::StormFile> DescribeFile(const std::string& path,
                                                    const storm_files::StormFormats& formats);

// Describes each of the files of a batch. A file that needs longer than `patience` gets ABORTED
// (StormFormats::DescribeEach).
std::vector<absl::StatusOr<storm_files::StormFile>> DescribeBatch(
    const std::vector<std::string>& paths, const storm_files::StormFormats& formats,
    std::chrono::milliseconds patience);

// Describes each of the files, in batches. If a batch takes too long, each of its files that is not
// yet described is described alone. `before` is called before each batch and before each file that
// is described alone. If it returns false, the remaining files get CANCELLED.
std::vector<absl::StatusOr<storm_files::StormFile>> DescribeInBatches(
    const std::vector<std::string>& paths, const storm_files::StormFormats& formats,
    const std::function<bool()>& before);

}  // namespace thunderhead::storm_store
