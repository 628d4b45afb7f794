#include "app/server_link.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "app/address.h"
#include "app/local_service.h"
#include "base/status.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"

namespace thunderhead::app {
namespace {

constexpr int kMaxResponseBytes = 128 << 20;
// Maximum delay between attempts to reconnect. It is short, so that a restarted server is found
// soon.
constexpr int kMaxReconnectBackoffMs = 2000;

}  // namespace

void AddServerFlags(CLI::App& command, ServerFlags& flags) {
  command.add_option("--server", flags.address, "HOST:PORT of a running server's gRPC service");
  AddClientAccessFlags(command, flags.access);
}

absl::StatusOr<std::unique_ptr<ServerLink>> ServerLink::Open(const ServerFlags& flags) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const app::Address address, ParseAddress("--server", flags.address));
  THUNDERHEAD_ASSIGN_OR_RETURN(const load::Access access, ReadClientAccess(flags.access));
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxResponseBytes);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectBackoffMs);
  const auto credentials = access.tls_roots.empty()
                               ? grpc::InsecureChannelCredentials()
                               : grpc::SslCredentials({access.tls_roots, "", ""});
  return std::unique_ptr<ServerLink>(
      new ServerLink(ToString(address), access.token,
                     grpc::CreateCustomChannel(ToString(address), credentials, arguments)));
}

ServerLink::ServerLink(std::string address, std::string token,
                       std::shared_ptr<grpc::Channel> channel)
    : address_(std::move(address)),
      token_(std::move(token)),
      channel_(std::move(channel)),
      service_(v1::ThunderheadService::NewStub(channel_)),
      jobs_(v1::RenderJobService::NewStub(channel_)) {}

void ServerLink::Prepare(grpc::ClientContext& context) const {
  if (!token_.empty()) context.AddMetadata("authorization", absl::StrCat("Bearer ", token_));
}

absl::Status ServerLink::StatusOf(const grpc::Status& status) const {
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED) {
    return absl::UnimplementedError(
        absl::StrCat("the server at ", address_,
                     " is older than this program and has no render jobs: run both in the same "
                     "version"));
  }
  absl::Status same = FromGrpc(status);
  if (!absl::IsUnavailable(same) && !absl::IsDeadlineExceeded(same)) return same;
  return base::Annotate(same, absl::StrCat("the server at ", address_, " cannot be reached"));
}

}  // namespace thunderhead::app
