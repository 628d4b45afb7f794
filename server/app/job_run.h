// Makes the pictures of a plan by a server's render jobs, on the rules of PictureRun: each once,
// whole, with its line in the manifest. What the server has drawn for a run that was stopped is
// fetched, not drawn again.
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

// The storm of that id, or an error that says which there are.
absl::StatusOr<v1::StormDescription> DescribeStorm(ServerLink& server, const std::string& id);

// As PlanOf for storms of this machine; `number` is the storm's in the plan.
absl::StatusOr<std::vector<PlannedPicture>> PlanOfServer(
    const PictureRunOptions& options, const ServerLink& server, const v1::StormDescription& storm,
    std::size_t number, const std::vector<int>& times, bool assume_run);

// As PictureRun::Make. A server that is lost is waited for, for a minute; UNAVAILABLE after that.
absl::Status MakeByJobs(ServerLink& server, PictureRun& run, std::vector<PlannedPicture>& pictures,
                        RunProgress& progress, const std::stop_token& stop);

}  // namespace thunderhead::app
