// The flags of commands that call a server: the access token and the TLS certificates.
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

// Reads the credentials. The token comes from the file or from $THUNDERHEAD_TOKEN. It is not a
// flag, because every user of the machine can read flags in the list of processes. Errors of files
// name the flag. Returns INVALID_ARGUMENT if the token has characters other than printable ASCII.
absl::StatusOr<load::Access> ReadClientAccess(const ClientAccessFlags& flags);

}  // namespace thunderhead::app
