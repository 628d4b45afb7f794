// The clouds that a server generated on request: a folder of storm files, to which one cloud at a
// time is added and from which clouds can be deleted. Safe to call from any thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <system_error>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "base/patient_calls.h"
#include "clouds/cloud_file.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

class CloudStore {
 public:
  // `path` is the folder; if empty, no clouds are generated. Generated clouds that the storm store
  // has already loaded from the folder are those of an earlier server, and can be deleted too.
  // The memory taken to generate a cloud counts in `memory`, which may be null.
  CloudStore(std::string path, storm_store::StormStore& store,
             std::shared_ptr<base::MemoryBudget> memory = nullptr);

  // Generates the cloud into a file of its own and adds it to the storm store, for the identity
  // `owner` (empty: nobody's). FAILED_PRECONDITION without a folder, RESOURCE_EXHAUSTED at the
  // maximum number, in all or of one identity since the server started, or without memory,
  // UNAVAILABLE during another call, DEADLINE_EXCEEDED if the folder's storage hangs as it begins.
  absl::StatusOr<storm_store::StormInfoPtr> Make(const clouds::CloudShape& shape,
                                                 const clouds::CloudOrigin& origin,
                                                 const clouds::GenerateObserver& observer,
                                                 const std::stop_token& stop,
                                                 const std::string& owner = "");

  // True if the storm is one of these clouds.
  bool Holds(const std::string& storm_id) const;

  // Removes a cloud's file, and the cloud from the storm store. NOT_FOUND for an unknown id,
  // FAILED_PRECONDITION for another storm, PERMISSION_DENIED if the file cannot be removed,
  // DEADLINE_EXCEEDED if its storage hangs; the file may be removed later, and the cloud is kept.
  absl::Status Delete(const std::string& storm_id);

 private:
  // DEADLINE_EXCEEDED if the storage of the folder hangs.
  absl::Status FolderAnswers();
  // A path whose name no file or storm has, and no deleted cloud had.
  std::string NewPath(const clouds::CloudOrigin& origin) const;
  // Removes a file, and gives the system's error; DEADLINE_EXCEEDED if the storage hangs.
  absl::StatusOr<std::error_code> Remove(const std::string& path);
  // The file of a cloud; errors as of Delete.
  absl::StatusOr<std::string> PathOf(const std::string& storm_id) const;
  bool WasUsed(const std::string& id) const;

  const std::string path_;
  storm_store::StormStore& store_;
  const std::shared_ptr<base::MemoryBudget> memory_;
  base::PatientCalls patient_{std::chrono::seconds(10)};  // for what the storage is asked
  std::mutex making_;                                     // held while a cloud is generated
  mutable std::mutex mutex_;  // never while the storage is asked, which may hang
  struct File {
    std::string path;
    std::string owner;
  };
  std::map<std::string, File> files_;  // of the clouds, by storm id
  std::set<std::string> used_ids_;     // not reused: a viewer may still show a deleted cloud
};

}  // namespace thunderhead::service
