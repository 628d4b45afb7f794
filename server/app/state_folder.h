// Where `serve` keeps what outlives it.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "base/patient_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"

namespace thunderhead::app {

// State that outlives the server, each null if it ends with it.
struct State {
  std::shared_ptr<session::SessionStore> sessions;
  std::shared_ptr<jobs::JobStore> jobs;
  std::string folder;  // empty: none
  // Tells whether the folder's storage hangs; both stores are UNAVAILABLE then.
  std::shared_ptr<base::PatientCalls> calls;
};

// The state in the folder, which is created for this user only; nothing for "none". An empty
// `folder` is the service manager's ($STATE_DIRECTORY) or the user's; if that cannot be created,
// nothing, with a warning.
absl::StatusOr<State> OpenState(const std::string& folder);

}  // namespace thunderhead::app
