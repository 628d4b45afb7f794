// Finds the storms under some paths, and the file and record of each of their times. Reads only
// metadata.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "volume/storm_file.h"
#include "volume/storm_format.h"
#include "volume/storm_store.h"

namespace thunderhead::volume {

// The file and record of one time of a storm.
struct TimeSource {
  std::size_t file = 0;    // index into CataloguedStorm::files
  std::size_t record = 0;  // in that file
};

struct CataloguedStorm {
  StormInfo info;
  std::vector<StormFile> files;
  std::vector<TimeSource> sources;  // one for each of info.times
};

// The storms under `paths`: those of the first path first, and those of one path in order of id.
// The rules and errors are those of StormStore::Open.
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormFormats& formats);

// The files by the runs that they may be parts of: same domain, grid, fields and start.
std::vector<std::vector<StormFile>> FilesOfRuns(std::vector<StormFile> files);

// Makes one storm of the files of one run: times in order; if several files have the same time, the
// last file's is used. `files` must not be empty.
CataloguedStorm AssembleStorm(const std::string& name, std::vector<StormFile> files);

}  // namespace thunderhead::volume
