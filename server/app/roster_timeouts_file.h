// The hidden flag --roster-timeouts of `thunderhead serve`: a file with the timeouts of people in
// sessions. Browser tests change it while the server runs. They can so end a wait when they need
// it, on a machine of any speed.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "session/roster.h"

namespace thunderhead::app {

// Reads pairs such as "come_back 10": a member of RosterTimeouts and its value in seconds. Omitted
// members keep their defaults. The error INVALID_ARGUMENT names what cannot be parsed.
absl::StatusOr<session::RosterTimeouts> ReadRosterTimeouts(const std::string& path);

// Calls `take` with the timeouts in the file, at once and each time that a new file is moved to the
// path. It logs the number of calls. The thread runs until it is told to stop.
std::jthread FollowRosterTimeouts(std::string path,
                                  std::function<void(const session::RosterTimeouts&)> take);

}  // namespace thunderhead::app
