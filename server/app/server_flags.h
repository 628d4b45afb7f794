// The flags of commands that can use a running server.
#pragma once

#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "app/client_access.h"
#include "runs/server_link.h"

namespace thunderhead::app {

struct ServerFlags {
  std::string address;  // HOST:PORT; empty for no server
  ClientAccessFlags access;
};

void AddServerFlags(CLI::App& command, ServerFlags& flags);

// Returns a link to the server, without waiting for it. INVALID_ARGUMENT names the wrong flag.
absl::StatusOr<std::unique_ptr<runs::ServerLink>> OpenServer(const ServerFlags& flags);

}  // namespace thunderhead::app
