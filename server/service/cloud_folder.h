// Where a server keeps the clouds that it was asked to make: a folder of storm files, to which one
// cloud at a time is added. Safe to call from any thread.
#pragma once

#include <cstddef>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "clouds/cloud_file.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

class CloudFolder {
 public:
  // Empty `path`: no clouds are made.
  CloudFolder(std::string path, volume::StormStore& store)
      : path_(std::move(path)), store_(store) {}

  // Generates the cloud into a file of its own and adds it to the store. FAILED_PRECONDITION
  // without a folder, RESOURCE_EXHAUSTED when enough were made, UNAVAILABLE while another is.
  absl::StatusOr<const volume::StormInfo*> Make(const clouds::CloudShape& shape,
                                                const clouds::CloudOrigin& origin,
                                                const clouds::GenerateObserver& observer,
                                                const std::stop_token& stop);

 private:
  std::string NewPath(const clouds::CloudOrigin& origin) const;

  const std::string path_;
  volume::StormStore& store_;
  std::mutex making_;
  std::size_t made_ = 0;
};

}  // namespace thunderhead::service
