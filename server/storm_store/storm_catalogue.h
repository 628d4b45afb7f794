// Finds the storms under some paths, and the file and record of each of their times. It reads only
// metadata.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "storm_files/storm_file.h"
#include "storm_files/storm_format.h"
#include "storm_store/assembled_storm.h"
#include "storm_store/described_files.h"
#include "storm_store/folder_walk.h"
#include "storm_store/runs_of_files.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

using FoundByPath = std::map<std::string, std::vector<NamedFiles>>;

// Options and callbacks of a search.
struct StormSearch {
  // Describes the files of a folder, or one file, each separately. The result is CANCELLED for a
  // file that must be skipped silently.
  std::function<std::vector<absl::StatusOr<storm_files::StormFile>>(
      const std::vector<std::string>&)>
      describe;
  // Describes the files of one time that is spread over several. Returns CANCELLED for a time that
  // must be skipped silently.
  std::function<absl::StatusOr<storm_files::StormFile>(const std::vector<std::string>&)>
      describe_together;
  // True if a missing path and a folder without storms are not errors.
  bool may_find_nothing = false;
  // Called with a folder or link below a path that is left out, and the reason. If the function is
  // empty, the reason is logged.
  std::function<void(const std::string&, const absl::Status&)> on_unlisted;
  // Called with every folder before it is listed. It may be empty.
  std::function<void(const std::string&)> on_folder;
  std::string examples;  // example files, for messages
  // Called before each path is searched. False means that the path's storage hangs, and the storms
  // that the previous search found there are used again. If the function is empty, all storage
  // counts as answering.
  std::function<bool(const std::string&)> answers = nullptr;
  // The storms that the previous search found under each path, used if `answers` returns false. The
  // caller owns the map, and each search updates it. It may be null.
  FoundByPath* found = nullptr;
  LinkPolicy links = {};
  // A request to stop ends the search between two files, with CANCELLED.
  std::stop_token stop = {};
  // Called once with the files of all folders, before `describe` is called for the files of each
  // folder. It may describe files in any order. The function may be empty.
  std::function<void(const std::vector<ListedFolder>&)> prepare = nullptr;
  // Called with the reason why a file is left out. If the function is empty, the reason is logged.
  std::function<void(const absl::Status&)> on_left_out = nullptr;
  // See FolderWalk.
  std::function<std::vector<std::string>(const std::string&)> known_below = nullptr;
  std::size_t most_entries = 200'000;
};

// Checks a file that was opened by `path`. `place` is the file's real path, without symbolic links.
// Returns PERMISSION_DENIED if the rules for links do not allow that place for a search of `paths`.
absl::Status CheckPlace(const std::vector<std::string>& paths, const LinkPolicy& links,
                        const std::string& path, const std::string& place);

// Returns the error of a file that is no storm. `path` may also name one storm of a file, as in
// "eps.grib2/mem05". Returns NOT_FOUND, with the names of the file's storms, if there is no such
// storm.
absl::Status CheckFile(const std::string& path, const storm_files::StormFormats& formats);

// Returns the storms under `paths`, in the order of the paths and by id within a path. The rules
// and errors are those of StormStore::Open. Returns CANCELLED if `stop` is requested.
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const storm_files::StormFormats& formats,
                                                        const LinkPolicy& links = {},
                                                        const std::stop_token& stop = {});
absl::StatusOr<std::vector<CataloguedStorm>> FindStorms(const std::vector<std::string>& paths,
                                                        const StormSearch& search);

// Logs the assumptions about the storms, for example which of two files with the same time is used.
// If `logged` is not null, the notes in it are skipped, and those that are logged are added to it.
void LogNotes(const std::vector<CataloguedStorm>& storms, std::set<std::string>* logged = nullptr);

}  // namespace thunderhead::storm_store
