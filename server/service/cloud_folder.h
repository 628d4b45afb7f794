// Where a server keeps the clouds that it was asked to make: a folder of storm files, to which one
// cloud at a time is added, and from which they can be deleted. Safe to call from any thread.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "clouds/cloud_file.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

class CloudFolder {
 public:
  // Empty `path`: no clouds are made. The store's storms that the generator wrote into the folder
  // count as made here, by an earlier server.
  CloudFolder(std::string path, volume::StormStore& store);

  // Generates the cloud into a file of its own and adds it to the store. FAILED_PRECONDITION
  // without a folder, RESOURCE_EXHAUSTED when there are enough, UNAVAILABLE while another is made.
  absl::StatusOr<const volume::StormInfo*> Make(const clouds::CloudShape& shape,
                                                const clouds::CloudOrigin& origin,
                                                const clouds::GenerateObserver& observer,
                                                const std::stop_token& stop);

  // Whether the storm is a cloud that was made here.
  bool Holds(const std::string& storm_id) const;

  // Removes a cloud's file and makes the store forget it. NOT_FOUND for an unknown id,
  // FAILED_PRECONDITION for a storm that was not made here, and what keeps the file from going.
  absl::Status Delete(const std::string& storm_id);

 private:
  std::string NewPath(const clouds::CloudOrigin& origin) const;

  const std::string path_;
  volume::StormStore& store_;
  std::mutex making_;  // held while a cloud is made
  mutable std::mutex mutex_;
  std::map<std::string, std::string> files_;  // of the clouds, by storm id
  std::set<std::string> used_ids_;  // never given again: who still shows one must not get another
};

}  // namespace thunderhead::service
