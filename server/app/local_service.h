// The service in this process, for commands that work on a file without a server.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "grpcpp/support/status.h"
#include "service/server.h"
#include "storm_store/storm_store.h"

namespace thunderhead::app {

// Opens the file or folder at `path`, which must contain exactly one storm.
absl::StatusOr<std::shared_ptr<storm_store::StormStore>> OpenStorm(const std::string& path);

// The index of the time wanted of the storm, which the user named by `path`; if none is, of the
// last. INVALID_ARGUMENT if it does not have that time.
absl::StatusOr<int> TimeOf(const storm_store::StormStore& store, const std::string& path,
                           std::optional<int> wanted);

// The error of a storm's file: whatever code the store gives a bad one, it is DATA_LOSS and no
// wrong request.
absl::Status AsFileProblem(const absl::Status& status);
// The same of the file at `path`. What is damaged may still be being written if it changed within
// the last two minutes: it is UNAVAILABLE then.
absl::Status AsFileProblem(const std::string& path, const absl::Status& status);

// Reads one time of the store's storm into its cache, with a progress bar.
absl::Status ReadWithProgress(storm_store::StormStore& store, int time_index);

// The fields of one time of the storm at `path`, read with a progress bar; errors as above.
absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadStorm(
    const std::string& path, std::optional<int> wanted);

// The service on `store`, drawing on `device`, without a listening port.
absl::StatusOr<std::unique_ptr<service::Server>> StartLocalService(
    std::shared_ptr<storm_store::StormStore> store, const std::string& device);

// The same code and message.
absl::Status FromGrpc(const grpc::Status& status);

}  // namespace thunderhead::app
