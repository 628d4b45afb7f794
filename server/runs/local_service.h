// The service run inside a command, for commands that work on a file without a server.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/channel.h"
#include "grpcpp/support/status.h"
#include "service/server.h"
#include "storm_store/storm_store.h"

namespace thunderhead::runs {

// Returns how long a read may make no progress before its storage counts as hanging. It is longer
// than a reader process may be silent (sandbox::ReaderLimits), so that a reader that hangs is ended
// first. The error then says that the reader hung, and not the storage.
std::chrono::milliseconds LocalReadDeadline();

// Opens the file or folder at `path`, which must contain exactly one storm. If `stop` is requested,
// this function and reads of the store end with CANCELLED.
absl::StatusOr<std::shared_ptr<storm_store::StormStore>> OpenStorm(
    const std::string& path, const std::stop_token& stop = {});

// Returns the index of the time `wanted`, or of the last time if `wanted` is absent.
// INVALID_ARGUMENT if the storm does not have that time; the error names the storm by `path`.
absl::StatusOr<int> TimeOf(const storm_store::StormStore& store, const std::string& path,
                           std::optional<int> wanted);

// Returns true if the error means that a complete storm file can never be read as it is. It must be
// converted first, or needs more memory than is available. Returns false for a file that is no
// storm file (INVALID_ARGUMENT).
bool IsLastingRefusal(const absl::Status& status);

// Converts INVALID_ARGUMENT and the errors of IsLastingRefusal about a storm's file to DATA_LOSS,
// so that a bad file is not reported as a wrong request. Returns other errors unchanged.
absl::Status AsFileProblem(const absl::Status& status);
// Converts an error about the file at `path` in the same way. DATA_LOSS, which means a damaged
// file, becomes UNAVAILABLE if the file has changed within the last two minutes, because a model
// may still be writing it.
absl::Status AsFileProblem(const std::string& path, const absl::Status& status);

// Reads one time of the store's storm into its cache, with a progress bar.
absl::Status ReadWithProgress(storm_store::StormStore& store, int time_index);

// Returns the fields of one time of the storm at `path`, read with a progress bar. Errors are
// converted as by AsFileProblem.
absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadStorm(
    const std::string& path, std::optional<int> wanted);

// Starts the service for `store`, drawing on `device`, without a listening port. Returns
// FAILED_PRECONDITION if that fails, or INVALID_ARGUMENT for a wrong device.
absl::StatusOr<std::unique_ptr<service::Server>> StartLocalService(
    std::shared_ptr<storm_store::StormStore> store, const std::string& device);

// Converts a gRPC status to a status with the same code and message.
absl::Status FromGrpc(const grpc::Status& status);

}  // namespace thunderhead::runs
