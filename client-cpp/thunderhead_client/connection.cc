#include "thunderhead_client/connection.h"

#include <arpa/inet.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace thunderhead::client {
namespace {

// Maximum size of a received message. An image of 8192 x 8192 pixels fits into one message.
constexpr int kMaxMessage_bytes = 256 << 20;
// The session's back-off decides when to reconnect. The channel's own back-off would wait up to two
// minutes.
constexpr int kReconnectFirst_ms = 100;
constexpr int kReconnectLongest_ms = 500;
// Timeout of one connection attempt, which includes TLS's round trips over a slow link. gRPC uses
// its minimum back-off for this purpose, despite the name.
constexpr int kConnectPatience_ms = 10'000;
constexpr std::chrono::seconds kReconnectPatience{8};

constexpr absl::string_view kPemCertificate = "-----BEGIN CERTIFICATE-----";

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
  int port = 0;
  const bool is_address =
      colon != std::string::npos && colon > 0 && !absl::StrContains(address, "/") &&
      absl::SimpleAtoi(address.substr(colon + 1), &port) && port >= 1 && port <= 65535;
  if (!is_address) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", address, "' is not HOST:PORT; give the server's gRPC port, such as ",
                     "localhost:50051, not the address of its page"));
  }
  return absl::OkStatus();
}

// Returns whether HOST:PORT is an address of this machine.
bool IsLoopback(const std::string& address) {
  std::string host = address.substr(0, address.rfind(':'));
  if (host.size() > 1 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  if (host == "localhost" || host == "::1") return true;
  in_addr v4{};
  constexpr std::uint32_t kLoopbackNetwork = 127;
  return inet_pton(AF_INET, host.c_str(), &v4) == 1 && ntohl(v4.s_addr) >> 24U == kLoopbackNetwork;
}

absl::Status CheckTokenIsSafe(const ServerAccess& access) {
  if (access.token_file.empty() || !access.tls_ca_file.empty() || access.allow_plaintext_token ||
      IsLoopback(access.address)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "the token is not sent to ", access.address, " without encryption, because others on the ",
      "network could read it; give --tls-ca, or --allow-plaintext-token if you trust the network"));
}

std::string Unreachable(const std::string& address) {
  return absl::StrCat("The server at ", address, " cannot be reached");
}

}  // namespace

void Canceller::Cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = true;
  for (grpc::ClientContext* const context : running_) context->TryCancel();
}

Canceller::Running::Running(Canceller& canceller, grpc::ClientContext& context)
    : canceller_(canceller), context_(context) {
  const std::lock_guard lock(canceller_.mutex_);
  canceller_.running_.insert(&context_);
  // TryCancel() before the call's beginning ends the call as soon as it begins.
  if (canceller_.cancelled_) context_.TryCancel();
}

Canceller::Running::~Running() {
  const std::lock_guard lock(canceller_.mutex_);
  canceller_.running_.erase(&context_);
}

absl::StatusOr<std::shared_ptr<Connection>> Connection::Open(ServerAccess access) {
  if (const absl::Status status = CheckAddress(access.address); !status.ok()) return status;
  if (const absl::Status status = CheckTokenIsSafe(access); !status.ok()) return status;
  auto credentials = grpc::InsecureChannelCredentials();
  if (!access.tls_ca_file.empty()) {
    absl::StatusOr<std::string> roots =
        ReadFile(access.tls_ca_file, "the certificates of --tls-ca");
    if (!roots.ok()) return roots.status();
    if (!absl::StrContains(*roots, kPemCertificate)) {
      return absl::InvalidArgumentError(absl::StrCat(
          "'", access.tls_ca_file, "' contains no certificate in PEM (", kPemCertificate,
          "); give the certificate of the authority that signed the server's, or the server's "
          "own"));
    }
    credentials = grpc::SslCredentials({*std::move(roots), "", ""});
  }
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessage_bytes);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kReconnectFirst_ms);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectPatience_ms);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kReconnectLongest_ms);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  const auto channel = grpc::CreateCustomChannel(access.address, credentials, arguments);
  std::shared_ptr<Connection> connection(new Connection(std::move(access), channel));
  grpc::ClientContext probe;
  if (const absl::Status status = connection->Authorize(probe); !status.ok()) return status;
  return connection;
}

Connection::Connection(ServerAccess access, const std::shared_ptr<grpc::Channel>& channel)
    : access_(std::move(access)),
      channel_(channel),
      stub_(v1::ThunderheadService::NewStub(channel)) {}

void Connection::AwaitReconnection(const std::function<bool()>& gives_up) const {
  constexpr std::chrono::milliseconds kSlice{100};
  const bool failed = channel_->GetState(true) == GRPC_CHANNEL_TRANSIENT_FAILURE;
  const auto deadline = std::chrono::system_clock::now() + kReconnectPatience;
  while (std::chrono::system_clock::now() < deadline && !gives_up()) {
    const grpc_connectivity_state state = channel_->GetState(true);
    if (state == GRPC_CHANNEL_READY || state == GRPC_CHANNEL_SHUTDOWN) return;
    // After its first failure a channel stays in TRANSIENT_FAILURE until it is connected.
    if (!failed && state == GRPC_CHANNEL_TRANSIENT_FAILURE) return;
    channel_->WaitForStateChange(state, std::chrono::system_clock::now() + kSlice);
  }
}

std::string Connection::Explain(const grpc::Status& status) const {
  // An UNAVAILABLE error without details comes from gRPC, because Thunderhead's own errors have
  // details.
  if (status.error_code() != grpc::StatusCode::UNAVAILABLE || !status.error_details().empty()) {
    return status.error_message();
  }
  // gRPC 1.51 has no status codes for these cases, so their messages are compared.
  if (absl::StrContains(status.error_message(), "http1.x")) {
    return absl::StrCat(
        address(),
        " answers by HTTP, so it is probably the port of the server's page; give its gRPC port, ",
        "by default 50051");
  }
  if (access_.tls_ca_file.empty()) {
    if (!absl::StrContains(status.error_message(), "Socket closed")) return Unreachable(address());
    return absl::StrCat(
        address(), " answers, but closes the connection: if it needs TLS, give its certificate ",
        "with --tls-ca; otherwise it may have too many connections, so try again later");
  }
  const bool answers = absl::StrContains(status.error_message(), "handshake failed") ||
                       absl::StrContains(status.error_message(), "peer certificate");
  if (!answers) return Unreachable(address());
  return absl::StrCat(address(),
                      " answers, but its TLS certificate is not signed by an authority in '",
                      access_.tls_ca_file, "', or does not name this host");
}

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
