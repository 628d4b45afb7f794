// Shares the time of a search fairly between folders, so that slow files in one folder do not delay
// those of another. A folder shares the time of the folder above it with its neighbours.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace thunderhead::storm_store {

// Sorts a folder directly before its subfolders, as in "a", "a/x", "a-b".
struct FolderOrder {
  bool operator()(const std::string& one, const std::string& other) const;
};
using FolderSet = std::set<std::string, FolderOrder>;

class FairFolders {
 public:
  // Returns the folder of `waiting` that is served next. At each level, this is the folder whose
  // files and subfolders have used the least time so far. If several have used equal time, the one
  // that has waited longest comes first. `waiting` must not be empty.
  const std::string& Next(const FolderSet& waiting);

  // Adds the time that was spent on a folder's files.
  void Used(const std::string& folder, double seconds);

  // Forgets the folders that are neither in `waiting` nor above a folder of it.
  void KeepOnly(const FolderSet& waiting);

 private:
  struct Share {
    double used_s = 0.0;
    std::uint64_t came = 0;  // folders are numbered in the order in which they came to wait
  };

  Share& ShareOf(const std::string& key);

  std::map<std::string, Share> shares_;
  std::uint64_t came_ = 0;
};

}  // namespace thunderhead::storm_store
