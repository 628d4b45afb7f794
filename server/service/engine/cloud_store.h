// The clouds that a server generates on request. They are storm files in one folder. Clouds are
// generated one at a time, and can be deleted. Safe to call from any thread.
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
#include "base/timed_calls.h"
#include "clouds/cloud_file.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

class CloudStore {
 public:
  // `path` is the folder; if it is empty, no clouds can be generated. Clouds that the storm store
  // has already loaded from the folder were made by an earlier server run, and can be deleted too.
  // The memory for generating a cloud is reserved in `memory`, which may be null (no limit).
  CloudStore(std::string path, storm_store::StormStore& store,
             std::shared_ptr<base::MemoryBudget> memory = nullptr);

  // Generates the cloud into a new file and adds it to the storm store, for the identity `owner`
  // (empty for none). Returns FAILED_PRECONDITION without a folder, and UNAVAILABLE while another
  // call generates a cloud. Returns DEADLINE_EXCEEDED if the folder's storage does not respond at
  // the start. Returns RESOURCE_EXHAUSTED without enough memory, or at the maximum number of
  // clouds. The maximum applies to all clouds, and to those that one identity has made since the
  // server started.
  absl::StatusOr<storm_store::StormInfoPtr> Make(const clouds::CloudShape& shape,
                                                 const clouds::CloudOrigin& origin,
                                                 const clouds::GenerateObserver& observer,
                                                 const std::stop_token& stop,
                                                 const std::string& owner = "");

  // Returns true if the storm is a cloud of this store.
  bool Holds(const std::string& storm_id) const;

  // Removes the cloud's file, and the cloud from the storm store. Returns NOT_FOUND for an unknown
  // id, FAILED_PRECONDITION for a storm that is not a generated cloud, and PERMISSION_DENIED if the
  // file cannot be removed. Returns DEADLINE_EXCEEDED if the storage does not respond. In this case
  // the cloud is kept, although its file may still be removed later.
  absl::Status Delete(const std::string& storm_id);

 private:
  // Returns DEADLINE_EXCEEDED if the storage of the folder does not respond.
  absl::Status FolderAnswers();
  // Returns a path whose name is not used by any file, storm or deleted cloud.
  std::string NewPath(const clouds::CloudOrigin& origin) const;
  // Removes a file and returns the system's error. Returns DEADLINE_EXCEEDED if the storage does
  // not respond.
  absl::StatusOr<std::error_code> Remove(const std::string& path);
  // Returns the file of a cloud, or an error as from Delete.
  absl::StatusOr<std::string> PathOf(const std::string& storm_id) const;
  bool WasUsed(const std::string& id) const;

  const std::string path_;
  storm_store::StormStore& store_;
  const std::shared_ptr<base::MemoryBudget> memory_;
  base::TimedCalls patient_{std::chrono::seconds(10)};  // calls to the storage, with a timeout
  std::mutex making_;                                   // held while a cloud is generated
  mutable std::mutex mutex_;  // not held during calls to the storage, which may block
  struct File {
    std::string path;
    std::string owner;
  };
  std::map<std::string, File> files_;  // the clouds' files, by storm id
  // Ids are not reused, because a viewer may still show a deleted cloud.
  std::set<std::string> used_ids_;
};

}  // namespace thunderhead::service
