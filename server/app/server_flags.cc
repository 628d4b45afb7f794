#include "app/server_flags.h"

#include "app/address.h"
#include "base/status.h"

namespace thunderhead::app {

void AddServerFlags(CLI::App& command, ServerFlags& flags) {
  command.add_option("--server", flags.address, "HOST:PORT of a running server's gRPC service");
  AddClientAccessFlags(command, flags.access);
}

absl::StatusOr<std::unique_ptr<runs::ServerLink>> OpenServer(const ServerFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Address address, ParseAddress("--server", flags.address));
  THUNDERHEAD_ASSIGN_OR_RETURN(const load::Access access, ReadClientAccess(flags.access));
  return std::make_unique<runs::ServerLink>(
      runs::ServerPlace{ToString(address), access.token, access.tls_roots});
}

}  // namespace thunderhead::app
