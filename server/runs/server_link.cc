#include "runs/server_link.h"

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"
#include "runs/local_service.h"

namespace thunderhead::runs {
namespace {

constexpr int kMaxResponseBytes = 128 << 20;
// Maximum delay between attempts to reconnect. It is short, so that a restarted server is found
// soon.
constexpr int kMaxReconnectBackoffMs = 2000;

std::shared_ptr<grpc::Channel> ChannelTo(const ServerPlace& place) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxResponseBytes);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectBackoffMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, static_cast<int>(place.ping_interval.count()));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, static_cast<int>(place.ping_timeout.count()));
  // A call that waits for news sends no data. By default, gRPC would stop after two pings.
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  const auto credentials = place.tls_roots.empty()
                               ? grpc::InsecureChannelCredentials()
                               : grpc::SslCredentials({place.tls_roots, "", ""});
  return grpc::CreateCustomChannel(place.address, credentials, arguments);
}

}  // namespace

bool MayComeBack(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) ||
         absl::IsCancelled(status);
}

ServerLink::ServerLink(const ServerPlace& place)
    : address_(place.address),
      token_(place.token),
      channel_(ChannelTo(place)),
      service_(v1::ThunderheadService::NewStub(channel_)),
      jobs_(v1::RenderJobService::NewStub(channel_)) {}

void ServerLink::Prepare(grpc::ClientContext& context) const {
  if (!token_.empty()) context.AddMetadata("authorization", absl::StrCat("Bearer ", token_));
}

absl::Status ServerLink::StatusOf(const grpc::Status& status) const {
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED) {
    return absl::UnimplementedError(
        absl::StrCat("the server at ", address_,
                     " lacks a call that this program needs; run both in the same version (",
                     status.error_message(), ")"));
  }
  if (!status.ok() && stop_.stop_requested()) {
    return absl::CancelledError("interrupted; run the same command again to continue");
  }
  absl::Status same = FromGrpc(status);
  if (absl::IsUnavailable(same)) {
    return base::Annotate(same, absl::StrCat("the server at ", address_, " cannot be reached"));
  }
  if (!absl::IsDeadlineExceeded(same)) return same;
  return base::Annotate(same, absl::StrCat("the server at ", address_,
                                           " has not answered in time; look at its log, or try "
                                           "again"));
}

}  // namespace thunderhead::runs
