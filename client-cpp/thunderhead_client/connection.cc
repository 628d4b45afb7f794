#include "thunderhead_client/connection.h"

#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace thunderhead::client {
namespace {

// Stills of 8192 x 8192 pixels fit.
constexpr int kMaxMessage_bytes = 256 << 20;
// The session's own back-off decides when to connect again, not the channel's, which waits up to
// two minutes.
constexpr int kReconnectFirst_ms = 100;
constexpr int kReconnectLongest_ms = 500;

absl::StatusOr<std::string> ReadFile(const std::string& path, const std::string& purpose) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return absl::NotFoundError(
        absl::StrCat("cannot read ", purpose, " '", path, "'; check its path and permissions"));
  }
  return std::string(std::istreambuf_iterator<char>(file), {});
}

absl::Status CheckAddress(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", address, "' is no HOST:PORT; give the server's gRPC port, such as ",
                     "localhost:50051"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<Connection>> Connection::Open(ServerAccess access) {
  if (const absl::Status status = CheckAddress(access.address); !status.ok()) return status;
  auto credentials = grpc::InsecureChannelCredentials();
  if (!access.tls_ca_file.empty()) {
    absl::StatusOr<std::string> roots =
        ReadFile(access.tls_ca_file, "the certificates of --tls-ca");
    if (!roots.ok()) return roots.status();
    credentials = grpc::SslCredentials({*std::move(roots), "", ""});
  }
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessage_bytes);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kReconnectFirst_ms);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kReconnectFirst_ms);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kReconnectLongest_ms);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  const auto channel = grpc::CreateCustomChannel(access.address, credentials, arguments);
  std::shared_ptr<Connection> connection(new Connection(std::move(access), channel));
  grpc::ClientContext probe;
  if (const absl::Status status = connection->Authorize(probe); !status.ok()) return status;
  return connection;
}

Connection::Connection(ServerAccess access, const std::shared_ptr<grpc::Channel>& channel)
    : access_(std::move(access)), stub_(v1::ThunderheadService::NewStub(channel)) {}

absl::Status Connection::Authorize(grpc::ClientContext& context) const {
  if (access_.token_file.empty()) return absl::OkStatus();
  const absl::StatusOr<std::string> token =
      ReadFile(access_.token_file, "the token of --token-file");
  if (!token.ok()) return token.status();
  const std::string stripped(absl::StripAsciiWhitespace(*token));
  if (stripped.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the token file '", access_.token_file, "' is empty; put the token in it"));
  }
  context.AddMetadata("authorization", absl::StrCat("Bearer ", stripped));
  return absl::OkStatus();
}

std::chrono::milliseconds RetryAfter(const grpc::Status& status) {
  google::rpc::Status details;
  if (!details.ParseFromString(status.error_details())) return {};
  for (const auto& detail : details.details()) {
    google::rpc::RetryInfo retry;
    if (!detail.UnpackTo(&retry)) continue;
    return std::chrono::milliseconds(retry.retry_delay().seconds() * 1000 +
                                     retry.retry_delay().nanos() / 1'000'000);
  }
  return {};
}

}  // namespace thunderhead::client
