// Checks of the answers of a server. The server of `--server` may be broken or hostile, so a run
// uses only what these functions accept.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "thunderhead/v1/job.pb.h"
#include "thunderhead/v1/storm.pb.h"

namespace thunderhead::runs {

// Returns INTERNAL unless the description is of the storm `asked`, has at least one time, and its
// lead times are finite and at most 1e9 s (31 years). If `asked` is empty, the server chooses the
// storm.
absl::Status CheckDescription(const v1::StormDescription& storm, const std::string& asked);

// Returns why the picture of `product` failed. Returns UNKNOWN if the server gives no reason. A
// storm file that cannot be read is DATA_LOSS.
absl::Status FailureOf(const v1::RenderJobProblem& problem, const std::string& product);

// Returns the number, or 0 if it is not finite or is negative. A manifest cannot hold such a
// number.
double AsCost(double milliseconds);

}  // namespace thunderhead::runs
