// The folder in which `serve` keeps the state that must survive a restart.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "base/timed_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"
#include "storm_store/storm_store.h"

namespace thunderhead::app {

// The state that survives a restart. A null store means that its state is lost when the server
// ends.
struct State {
  std::shared_ptr<session::SessionStore> sessions;
  std::shared_ptr<jobs::JobStore> jobs;
  std::string folder;  // empty if no state is kept
  // Calls to the folder's storage. While they hang, both stores return UNAVAILABLE.
  std::shared_ptr<base::TimedCalls> calls;
};

// Opens the state in the folder, which is created for this user only. If `folder` is "none", no
// state is kept. If it is empty, the folder of the service manager ($STATE_DIRECTORY) or of the
// user is used. If such a default folder cannot be created, no state is kept, and a warning is
// logged. Returns INVALID_ARGUMENT if a named folder cannot be created. Returns
// FAILED_PRECONDITION, with the remedy, if other users may change the folder or if a file in it is
// no regular file. Also returns the errors of store::StateFile::Open.
absl::StatusOr<State> OpenState(const std::string& folder);

// Makes the catalogue of storms read their ids from the state, and keep them there. If the folder's
// storage fails or hangs, a warning is logged, and the ids depend on the files' names only.
void KeepStormIds(const State& state, storm_store::LiveCatalogueOptions& catalogue);

}  // namespace thunderhead::app
