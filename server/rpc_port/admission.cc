#include "rpc_port/admission.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "rpc_port/connection_of.h"

namespace thunderhead::rpc_port {
namespace {

constexpr char kScheme[] = "bearer ";

std::optional<std::string> Metadata(const grpc::CallbackServerContext& context, const char* name) {
  const auto [begin, end] = context.client_metadata().equal_range(name);
  if (begin == end) return std::nullopt;
  return std::string(begin->second.data(), begin->second.size());
}

// Returns all values of the x-forwarded-for header, in order.
std::string ForwardedFor(const grpc::CallbackServerContext& context) {
  const auto [begin, end] = context.client_metadata().equal_range("x-forwarded-for");
  std::string all;
  for (auto line = begin; line != end; ++line) {
    absl::StrAppend(&all, all.empty() ? "" : ",",
                    absl::string_view(line->second.data(), line->second.size()));
  }
  return all;
}

std::string PeerOf(const access::AccessControl& access_control,
                   const grpc::CallbackServerContext& context) {
  if (const auto connection = ConnectionOf(context); connection.has_value()) {
    return access_control.Proxies().ClientOf(*connection, ForwardedFor(context));
  }
  // The call came through the local socket, to which only this user's processes connect. The
  // gateway reports its client's address.
  return Metadata(context, "x-forwarded-for").value_or("");
}

}  // namespace

CallerOr Admit(access::AccessControl& access_control, const grpc::CallbackServerContext& context,
               const char* method, access::CallKind kind) {
  access::Credentials credentials{"", PeerOf(access_control, context)};
  const std::string header = Metadata(context, "authorization").value_or("");
  // If there are several tokens, a proxy in front may have checked a different one than this server
  // would. All of them are therefore rejected.
  const bool is_one = context.client_metadata().count("authorization") == 1;
  if (is_one && absl::StartsWithIgnoreCase(header, kScheme)) {
    credentials.token = header.substr(sizeof(kScheme) - 1);
  }
  return access_control.Admit(method, kind, std::move(credentials));
}

CallerOr Entrance::Enter(const grpc::CallbackServerContext& context, const char* method,
                         access::CallKind kind) const {
  CallerOr caller = Admit(access_control_, context, method, kind);
  if (caller.ok() && !closed_.ok()) return closed_;
  const std::optional<std::string> connection = ConnectionOf(context);
  if (!caller.ok() || !connection.has_value()) return caller;
  // Keeps the call counted while any copy of the caller exists.
  struct Counted {
    std::shared_ptr<const access::Caller> caller;
    std::shared_ptr<const void> call;
  };
  const auto counted =
      std::make_shared<const Counted>(Counted{*std::move(caller), calls_.Begin(*connection)});
  return std::shared_ptr<const access::Caller>(counted, counted->caller.get());
}

}  // namespace thunderhead::rpc_port
