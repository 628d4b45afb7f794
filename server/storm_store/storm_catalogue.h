// Finds the storms under some paths, and the file and record of each of their times. Reads only
// metadata.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include "absl/status/statusor.h"
#include "storm_files/storm_file.h"
#include "storm_files/storm_format.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

// The file and record of one time of a storm.
struct TimeSource {
  std::size_t file = 0;    // index into CataloguedStorm::files
  std::size_t record = 0;  // in that file
};

struct CataloguedStorm {
  StormInfo info;
  std::vector<storm_files::StormFile> files;
  std::vector<TimeSource> sources;  // one for each of info.times
  std::vector<std::string> notes;   // for the log: times that several files have
};

// Returns the file that a time of the storm is in.
inline const storm_files::StormFile& FileOf(const CataloguedStorm& storm, std::size_t time) {
  return storm.files[storm.sources[time].file];
}

// A storm's name and files, before it has an id.
struct NamedFiles {
  std::string name;
  std::vector<storm_files::StormFile> files;
};
using FoundByPath = std::map<std::string, std::vector<NamedFiles>>;

// Options and callbacks of a search.
struct StormSearch {
  // Describes the file at a path. CANCELLED for a file that is to be skipped silently.
  std::function<absl::StatusOr<storm_files::StormFile>(const std::string&)> describe;
  // True if a path that is gone and a folder without storms are no errors.
  bool may_find_nothing = false;
  // Called with a folder or link below a path that is left out, and why; empty: it is logged.
  std::function<void(const std::string&, const absl::Status&)> on_unlisted;
  // Called with every folder before it is listed; may be empty.
  std::function<void(const std::string&)> on_folder;
  std::string examples;  // of files, for messages
  // Called before each path is searched. Where it returns false the path's storage hangs, and the
  // storms found there by the search before are used again. Empty: all storage answers.
  std::function<bool(const std::string&)> answers = nullptr;
  // The storms found by the search before, for that purpose; owned by callers who search again and
  // again, and updated by each search.
  FoundByPath* found = nullptr;
  LinkPolicy links = {};
};

// PERMISSION_DENIED: the folder is there, but cannot be listed.
absl::Status CannotBeListed(const std::string& folder, const std::error_code& error);

// PERMISSION_DENIED if a file that was opened by `path` lies at a `place` that the rules for links
// do not allow for a search of `paths`. `place` has no links in it.
absl::Status CheckPlace(const std::vector<std::string>& paths, const LinkPolicy& links,
                        const std::string& path, const std::string& place);

// Describes files by the formats; a file whose metadata exhausts the memory is an error.
absl::StatusOr<storm_files::StormFile> DescribeFile(const std::string& path,
                                                    const storm_files::StormFormats& formats);

// The storms under `paths`: those of the first path first, and those of one path in order of id.
// The rules and errors are those of StormStore::Open.
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const storm_files::StormFormats& formats,
                                                        const LinkPolicy& links = {});
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormSearch& search);

void LogNotes(const std::vector<CataloguedStorm>& storms);

// Groups the files by run: those of one group have the same domain, grid, fields and start.
std::vector<std::vector<storm_files::StormFile>> FilesOfRuns(
    std::vector<storm_files::StormFile> files);

// Makes one storm of the files of one run: times in order; if several files have the same time, the
// last file's is used. `files` must not be empty.
CataloguedStorm AssembleStorm(const std::string& name, std::vector<storm_files::StormFile> files);

}  // namespace thunderhead::storm_store
