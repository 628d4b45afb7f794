// The signals that ask the program to stop.
#pragma once

#include <csignal>

namespace thunderhead::app {

// Returns SIGINT, SIGTERM and SIGHUP. A terminal sends SIGHUP when it is closed. SIGHUP is left out
// if the caller of the program ignores it, as nohup does.
sigset_t StopSignals();

}  // namespace thunderhead::app
