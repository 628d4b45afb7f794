// Where `serve` keeps what outlives it.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/session_store.h"

namespace thunderhead::app {

// The store in the folder, which is created for this user only; null for "none". An empty `folder`
// is the service manager's ($STATE_DIRECTORY) or the user's; if that cannot be created, null with a
// warning.
absl::StatusOr<std::shared_ptr<session::SessionStore>> OpenSessionStore(const std::string& folder);

}  // namespace thunderhead::app
