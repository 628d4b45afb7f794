#include "service/admission.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "base/error_details.h"

namespace thunderhead::service {
namespace {

constexpr char kScheme[] = "bearer ";

std::optional<std::string> Metadata(const grpc::CallbackServerContext& context, const char* name) {
  const auto [begin, end] = context.client_metadata().equal_range(name);
  if (begin == end) return std::nullopt;
  return std::string(begin->second.data(), begin->second.size());
}

// "1.2.3.4:80" or "[::1]:80" of gRPC's "ipv4:1.2.3.4:80" or "ipv6:%5B::1%5D:80".
std::string PeerOf(const grpc::CallbackServerContext& context) {
  const std::string peer = context.peer();
  absl::string_view address = peer;
  if (absl::ConsumePrefix(&address, "ipv4:") || absl::ConsumePrefix(&address, "ipv6:")) {
    return absl::StrReplaceAll(address, {{"%5B", "["}, {"%5D", "]"}});
  }
  // The local socket, to which only this user's processes connect: the gateway tells its client.
  return Metadata(context, "x-forwarded-for").value_or("");
}

}  // namespace

CallerOr Admit(access::Door& door, const grpc::CallbackServerContext& context, const char* method,
               access::CallKind kind) {
  access::Credentials credentials{"", PeerOf(context)};
  const std::string header = Metadata(context, "authorization").value_or("");
  if (absl::StartsWithIgnoreCase(header, kScheme)) {
    credentials.token = header.substr(sizeof(kScheme) - 1);
  }
  return door.Admit(method, kind, std::move(credentials));
}

}  // namespace thunderhead::service
