// Finds the storms under some paths and which record of which file each of their times is. Reads
// only metadata.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "volume/storm_file.h"
#include "volume/storm_format.h"
#include "volume/storm_store.h"

namespace thunderhead::volume {

// Where a time of a storm is kept.
struct TimeSource {
  std::size_t file = 0;    // index into CataloguedStorm::files
  std::size_t record = 0;  // in that file
};

struct CataloguedStorm {
  StormInfo info;
  std::vector<StormFile> files;
  std::vector<TimeSource> sources;  // one for each of info.times
};

// The storms under `paths`, in order of id; the rules and errors are those of StormStore::Open.
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormFormats& formats);

// Files of one run as one storm: times in order; of a time that several files hold, the last file's
// is kept. `files` must not be empty.
CataloguedStorm AssembleStorm(const std::string& name, std::vector<StormFile> files);

}  // namespace thunderhead::volume
