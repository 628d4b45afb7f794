#include "rpc_port/server_settings.h"

#include <grpcpp/resource_quota.h>

namespace thunderhead::rpc_port {
namespace {

// Interval of gRPC's keepalive pings. A viewer that disappeared without closing its connection is
// detected after this interval and kKeepaliveTimeout.
constexpr int kKeepaliveTimeMs = 20'000;
// The shortest interval of a client's pings. gRPC's default of 5 minutes would close the connection
// of a command that tests every 20 s whether the server still exists (runs/server_link).
constexpr int kMinPingIntervalMs = 10'000;
// Timeouts for a client that connects and sends nothing, and for one that starts no call.
constexpr int kHandshakeTimeoutMs = 10'000;
constexpr int kIdleConnectionMs = 60'000;

// Makes gRPC refuse compressed requests with UNIMPLEMENTED. A megabyte of gzip may contain a
// gigabyte, and gRPC would decompress a message before it checks the size.
void RefuseCompression(grpc::ServerBuilder& builder) {
  for (const auto algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
}

}  // namespace

void SetLimits(grpc::ServerBuilder& builder, const PortLimits& limits, int max_response_bytes) {
  grpc::ResourceQuota quota("thunderhead");
  quota.Resize(limits.grpc_memory_bytes);
  builder.SetResourceQuota(quota);
  builder.SetMaxReceiveMessageSize(static_cast<int>(limits.max_request_bytes));
  builder.SetMaxSendMessageSize(max_response_bytes);
  RefuseCompression(builder);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTimeMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS,
                             static_cast<int>(kKeepaliveTimeout.count()));
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, limits.max_streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleConnectionMs);
}

}  // namespace thunderhead::rpc_port
