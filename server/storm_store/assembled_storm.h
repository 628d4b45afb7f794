// Makes one storm of the files of a model run, with its times in order.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "storm_files/storm_file.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

// The file and record of one time of a storm.
struct TimeSource {
  std::size_t file = 0;    // index into CataloguedStorm::files
  std::size_t record = 0;  // index in that file
};

struct CataloguedStorm {
  StormInfo info;
  // The id that is made from the storm's name. If several storms have the same stem, numbers are
  // appended to make their ids different.
  std::string stem;
  std::size_t path = 0;  // index of the searched path
  std::vector<storm_files::StormFile> files;
  std::vector<TimeSource> sources;  // one for each of info.times
  std::vector<std::string> notes;   // messages for the log about what is odd in the files
};

// Returns the file that a time of the storm is in.
inline const storm_files::StormFile& FileOf(const CataloguedStorm& storm, std::size_t time) {
  return storm.files[storm.sources[time].file];
}

// Returns the valid time of a time of the storm.
inline absl::Time ValidTimeOf(const CataloguedStorm& storm, std::size_t time) {
  return FileOf(storm, time).times[storm.sources[time].record];
}

// Sets StormTime::elapsed_s and StormTime::lead_s of all times, from the files.
void CountTimes(CataloguedStorm& storm);

// Makes one storm of the files of one run, with its times in order. If several files have the same
// time, the file that was written last is used. If one file has a time twice, the later record is
// used. Notes report both, and fields that only some files have. `files` must not be empty.
CataloguedStorm AssembleStorm(const std::string& name, std::vector<storm_files::StormFile> files);

}  // namespace thunderhead::storm_store
