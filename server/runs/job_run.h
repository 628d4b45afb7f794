// Makes the pictures of a plan with a server's render jobs. The guarantees are those of PictureRun:
// each picture is made once, is complete, and has its line in the manifest. If a run was stopped,
// pictures that the server has drawn for it are fetched instead of drawn again.
#pragma once

#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "runs/picture_run.h"
#include "runs/run_progress.h"
#include "runs/server_link.h"
#include "thunderhead/v1/storm.pb.h"

namespace thunderhead::runs {

// Returns the storm with that id. The error for an unknown id lists the available storms. Returns
// INTERNAL if the server's answer is unusable (CheckDescription).
absl::StatusOr<v1::StormDescription> DescribeStorm(ServerLink& server, const std::string& id);

// Returns a plan for a storm of the server, as PlanOf does for a local storm. `number` is the index
// of the storm in the plan.
absl::StatusOr<std::vector<PlannedPicture>> PlanOfServer(
    const PictureRunOptions& options, const ServerLink& server, const v1::StormDescription& storm,
    std::size_t number, const std::vector<int>& times, bool assume_run);

// Makes the pictures, as PictureRun::Make does. If the connection to the server is lost, it retries
// for a minute and then returns the error, such as UNAVAILABLE.
absl::Status MakeByJobs(ServerLink& server, PictureRun& run, std::vector<PlannedPicture>& pictures,
                        RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::runs
