// Stores whose storage may hang, such as a network file system that is unreachable. Each call,
// including the one that closes the store, runs on a separate thread with the timeout of `calls`. A
// call that times out is UNAVAILABLE with the reason STORAGE_HANGS. Until it returns, all other
// calls of both stores fail at once in the same way. Only Load waits without a timeout; the log
// reports the wait.
#pragma once

#include <memory>
#include <string>

#include "base/patient_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"

namespace thunderhead::store {

// `folder` is the state folder; messages name the storage by it.
std::shared_ptr<session::SessionStore> WithPatience(std::shared_ptr<session::SessionStore> store,
                                                    std::shared_ptr<base::PatientCalls> calls,
                                                    const std::string& folder);
std::shared_ptr<jobs::JobStore> WithPatience(std::shared_ptr<jobs::JobStore> store,
                                             std::shared_ptr<base::PatientCalls> calls,
                                             const std::string& folder);

}  // namespace thunderhead::store
