// Lists the files below a folder that a user gave, within limits. If a folder has more files than
// the limits allow, its neighbours are listed nevertheless, because all subfolders get equal
// shares.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

// The rules by which a search follows symbolic links. All paths are canonical.
struct LinkRules {
  std::vector<std::filesystem::path> targets;    // links may lead only into these
  std::vector<std::filesystem::path> untrusted;  // links in these are not followed
};

// Returns the file of which `path` names a storm, as in "eps.grib2/mem05". Other paths are returned
// unchanged.
std::filesystem::path FileOfStorm(const std::filesystem::path& path);

// Returns the rules for a search below `paths`.
LinkRules LinkRulesOf(const std::vector<std::string>& paths, const LinkPolicy& links);

// Returns whether `path` is `folder` or below it. Both are canonical.
bool IsWithin(const std::filesystem::path& path, const std::filesystem::path& folder);
bool IsWithinAny(const std::filesystem::path& path,
                 const std::vector<std::filesystem::path>& folders);

// A folder and its files, in the order of their names.
struct ListedFolder {
  std::string path;
  std::vector<std::string> files;  // paths
};

struct FolderWalk {
  const LinkRules& links;
  // Called with every folder before it is listed. It may be empty.
  std::function<void(const std::string& path)> on_folder = {};
  // Called with each folder or link that is left out, and the reason.
  std::function<void(const std::string& path, const absl::Status& why)> on_left_out;
  // Returns the files below a folder that an earlier walk found. They are also listed if this walk
  // stops at a limit before it reaches them. It may be empty.
  std::function<std::vector<std::string>(const std::string& folder)> known_below = {};
  // Maximum number of files and folders below one path, and maximum time to list them.
  std::size_t most_entries = 200'000;
  std::chrono::milliseconds longest = std::chrono::minutes(10);
  const base::TimeSource* time = &base::SteadyTime();
  // A request to stop ends the walk, and what it has not listed is not reported.
  std::stop_token stop = {};
};

// Returns PERMISSION_DENIED for a folder that exists but cannot be listed.
absl::Status CannotBeListed(const std::string& folder, const std::error_code& error);

// Lists the folder `path` and its subfolders, each folder once, although links can make it appear
// in several places. The result is in the order of names, and a folder comes before its subfolders.
// At a limit, the rest is reported by one call of on_left_out with `path`. Returns
// PERMISSION_DENIED if `path` cannot be listed.
absl::StatusOr<std::vector<ListedFolder>> ListFolders(const std::string& path,
                                                      const FolderWalk& walk);

}  // namespace thunderhead::storm_store
