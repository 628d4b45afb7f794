// Stores whose storage may hang, as a network file system does that is gone: each call, also the
// last one that closes the store, has a thread of its own and so long as `calls` has patience.
// After that it is UNAVAILABLE with the reason STORAGE_HANGS, and so are all others, of both
// stores, at once until it has returned. Load alone waits for as long as it takes, and the log
// says so.
#pragma once

#include <memory>
#include <string>

#include "base/patient_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"

namespace thunderhead::store {

// `folder` is the state folder, by which messages name the storage.
std::shared_ptr<session::SessionStore> WithPatience(std::shared_ptr<session::SessionStore> store,
                                                    std::shared_ptr<base::PatientCalls> calls,
                                                    const std::string& folder);
std::shared_ptr<jobs::JobStore> WithPatience(std::shared_ptr<jobs::JobStore> store,
                                             std::shared_ptr<base::PatientCalls> calls,
                                             const std::string& folder);

}  // namespace thunderhead::store
