// The hidden flag --roster-timeouts of `thunderhead serve`: a file with the timeouts of people in
// sessions (session::RosterTimeouts). Browser tests change the file while the server runs. In this
// way they can end a wait when they need it, on a machine of any speed.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "session/roster.h"

namespace thunderhead::app {

// Reads lines such as "come_back 10": a member of RosterTimeouts and its value in seconds. Members
// that are not listed keep their defaults. INVALID_ARGUMENT names what cannot be parsed.
absl::StatusOr<session::RosterTimeouts> ReadRosterTimeouts(const std::string& path);

// Starts a thread that calls `take` with the timeouts in the file, at once and each time that a new
// file is moved to the path. It logs the number of calls. The thread runs until it is told to stop.
std::jthread FollowRosterTimeouts(std::string path,
                                  std::function<void(const session::RosterTimeouts&)> take);

}  // namespace thunderhead::app
