#include "app/client_access.h"

#include <cstdlib>

#include "absl/strings/ascii.h"
#include "base/status.h"
#include "base/whole_file.h"

namespace thunderhead::app {

void AddClientAccessFlags(CLI::App& command, ClientAccessFlags& flags) {
  command.add_option("--token-file", flags.token_file,
                     "File with the access token, for a server with --auth; by default the token "
                     "is $THUNDERHEAD_TOKEN");
  command.add_option("--tls-roots,--tls-ca", flags.tls_roots,
                     "PEM file of the certificate authorities that may sign the server's "
                     "certificate; without it the connection is not encrypted");
}

absl::StatusOr<load::Access> ReadClientAccess(const ClientAccessFlags& flags) {
  load::Access access;
  if (!flags.token_file.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(access.token, base::ReadWholeFile(flags.token_file));
  } else if (const char* token = std::getenv("THUNDERHEAD_TOKEN"); token != nullptr) {
    access.token = token;
  }
  absl::StripAsciiWhitespace(&access.token);
  for (const char c : access.token) {
    // gRPC aborts the process on metadata with other bytes, so they are rejected.
    if (!absl::ascii_isgraph(static_cast<unsigned char>(c))) {
      return absl::InvalidArgumentError(
          "the token is not printable ASCII without spaces; does --token-file name the right "
          "file?");
    }
  }
  if (!flags.tls_roots.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(access.tls_roots, base::ReadWholeFile(flags.tls_roots));
  }
  return access;
}

}  // namespace thunderhead::app
