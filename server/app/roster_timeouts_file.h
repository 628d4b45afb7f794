// The hidden flag --roster-timeouts of `thunderhead serve`: a file with the timeouts of people in
// sessions. Browser tests change it while the server runs, so that a wait ends when they want it
// to, on a machine of any speed.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "session/roster.h"

namespace thunderhead::app {

// Reads pairs such as "come_back 10": a member of RosterTimeouts and its value in seconds. Members
// that the file leaves out keep their defaults. INVALID_ARGUMENT names what it cannot parse.
absl::StatusOr<session::RosterTimeouts> ReadRosterTimeouts(const std::string& path);

// Calls `take` with the timeouts in the file at once and each time that another file is moved to
// the path, and logs how often it has done so. The thread runs until it is told to stop.
std::jthread FollowRosterTimeouts(std::string path,
                                  std::function<void(const session::RosterTimeouts&)> take);

}  // namespace thunderhead::app
