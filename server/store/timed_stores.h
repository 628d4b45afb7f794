// Wrappers that add timeouts to the stores, whose storage may hang, for example an unreachable
// network file system. Each call, including the closing of the store, runs on a separate thread
// with the timeout of `calls`. A call that times out returns UNAVAILABLE with the reason
// STORAGE_HANGS. Until the hanging call returns, all other calls of both stores return the same
// error at once. Only Load waits without a timeout; the log reports long waits.
#pragma once

#include <memory>
#include <string>

#include "base/timed_calls.h"
#include "jobs/job_store.h"
#include "session/session_store.h"

namespace thunderhead::store {

// `folder` is the state folder; messages name the storage by it.
std::shared_ptr<session::SessionStore> WithPatience(std::shared_ptr<session::SessionStore> store,
                                                    std::shared_ptr<base::TimedCalls> calls,
                                                    const std::string& folder);
std::shared_ptr<jobs::JobStore> WithPatience(std::shared_ptr<jobs::JobStore> store,
                                             std::shared_ptr<base::TimedCalls> calls,
                                             const std::string& folder);

}  // namespace thunderhead::store
