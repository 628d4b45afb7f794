#include "rpc_port/connection_of.h"

#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace thunderhead::rpc_port {

// gRPC writes "ipv4:1.2.3.4:80" or "ipv6:%5B::1%5D:80".
std::optional<std::string> ConnectionOf(const grpc::ServerContextBase& context) {
  const std::string peer = context.peer();
  absl::string_view address = peer;
  if (absl::ConsumePrefix(&address, "ipv4:") || absl::ConsumePrefix(&address, "ipv6:")) {
    return absl::StrReplaceAll(address, {{"%5B", "["}, {"%5D", "]"}});
  }
  return std::nullopt;
}

}  // namespace thunderhead::rpc_port
