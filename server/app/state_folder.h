// The folder in which `serve` keeps the state that outlives it.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "base/patient_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"

namespace thunderhead::app {

// State that outlives the server. Each store is null if its state ends with the server.
struct State {
  std::shared_ptr<session::SessionStore> sessions;
  std::shared_ptr<jobs::JobStore> jobs;
  std::string folder;  // empty for none
  // Reports whether the folder's storage hangs. Both stores then return UNAVAILABLE.
  std::shared_ptr<base::PatientCalls> calls;
};

// Opens the state in the folder, which is created for this user only. For "none" there is no state.
// An empty `folder` means the service manager's ($STATE_DIRECTORY) or the user's. If that one
// cannot be created, there is no state, and a warning is logged.
absl::StatusOr<State> OpenState(const std::string& folder);

}  // namespace thunderhead::app
