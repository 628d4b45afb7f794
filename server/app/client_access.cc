#include "app/client_access.h"

#include <cstdlib>

#include "absl/strings/ascii.h"
#include "base/named_file.h"
#include "base/status.h"

namespace thunderhead::app {
namespace {

constexpr std::size_t kMaxToken_bytes = 64 << 10;
// This limit is far above the 200 KiB that the certificates of all public authorities have
// together.
constexpr std::size_t kMaxTlsRoots_bytes = 4 << 20;

absl::StatusOr<std::string> ReadNamed(const char* flag, const std::string& path,
                                      std::size_t max_bytes) {
  absl::StatusOr<std::string> text = base::ReadBoundedFile(path, max_bytes);
  if (!text.ok()) return base::Annotate(text.status(), flag);
  return text;
}

}  // namespace

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
    THUNDERHEAD_ASSIGN_OR_RETURN(access.token,
                                 ReadNamed("--token-file", flags.token_file, kMaxToken_bytes));
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
    THUNDERHEAD_ASSIGN_OR_RETURN(access.tls_roots,
                                 ReadNamed("--tls-roots", flags.tls_roots, kMaxTlsRoots_bytes));
  }
  return access;
}

}  // namespace thunderhead::app
