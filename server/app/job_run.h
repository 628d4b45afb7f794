// Makes the pictures of a plan by a server's render jobs, with the guarantees of PictureRun: each
// is made once, is complete, and has its line in the manifest. Pictures that the server drew for a
// stopped run are fetched instead of drawn again.
#pragma once

#include <cstddef>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "app/picture_run.h"
#include "app/run_progress.h"
#include "app/server_link.h"
#include "thunderhead/v1/storm.pb.h"

namespace thunderhead::app {

// Returns the storm with that id, or an error that lists the storms.
absl::StatusOr<v1::StormDescription> DescribeStorm(ServerLink& server, const std::string& id);

// Returns the plan, as PlanOf does for storms of this machine. `number` is the storm's index in the
// plan.
absl::StatusOr<std::vector<PlannedPicture>> PlanOfServer(
    const PictureRunOptions& options, const ServerLink& server, const v1::StormDescription& storm,
    std::size_t number, const std::vector<int>& times, bool assume_run);

// Makes the pictures, as PictureRun::Make does. If the server is lost, it retries for a minute and
// then returns UNAVAILABLE.
absl::Status MakeByJobs(ServerLink& server, PictureRun& run, std::vector<PlannedPicture>& pictures,
                        RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
