// Describes a storm that one or several GRIB files hold. ICON's files have one field of one level
// each, so a time of its storms consists of hundreds of files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"
#include "storm_files/grib_source.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {

// Returns an input that opens the file at `path` by base::OpenBytes.
GribInput GribFileAt(const std::string& path);

// Reads the index of a file, compressed or not.
absl::StatusOr<std::shared_ptr<const grib::Index>> IndexOfGrib(
    std::shared_ptr<const base::ByteSource> bytes);

// Finds the storms in files with these indexes, one for each run and member, and their times. There
// is at least one. `path` names the files in errors. Errors name the file, the field and what to
// do.
absl::StatusOr<std::vector<std::shared_ptr<const GribStorm>>> MakeGribStorms(
    const std::string& path, const std::vector<GribInput>& files, const GribIndexes& indexes);

// Describes the storm, and sets the reader of its times.
StormFile DescribeGribStorm(std::shared_ptr<const GribStorm> storm);

}  // namespace thunderhead::storm_files
