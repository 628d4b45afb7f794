// The flags of commands that call a server which asks who they are, or speaks TLS.
#pragma once

#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "load/transport.h"

namespace thunderhead::app {

struct ClientAccessFlags {
  std::string token_file;
  std::string tls_roots;
};

void AddClientAccessFlags(CLI::App& command, ClientAccessFlags& flags);

// The token is the file's content or $THUNDERHEAD_TOKEN, never a flag, which every user of the
// machine could read in the list of processes.
absl::StatusOr<load::Access> ReadClientAccess(const ClientAccessFlags& flags);

}  // namespace thunderhead::app
